"""A bearing with its grooves as they wear."""
