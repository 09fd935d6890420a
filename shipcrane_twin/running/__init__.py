"""Runs from start to report: the node graph or the inline chain, watched, recorded and summed up."""
