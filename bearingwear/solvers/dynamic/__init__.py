"""A bearing that moves in time."""
