"""Digital twin of a ship, its deck crane and the load on the hook."""

__version__ = "0.1.0"
