"""One executable per module: thin shells around a subsystem."""
