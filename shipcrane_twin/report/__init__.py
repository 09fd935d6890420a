"""Figures, numbers and the page of a run, made from its bag."""
