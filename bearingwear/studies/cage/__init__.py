"""Which motion a cage takes, by its friction, its clearances and its weight."""
