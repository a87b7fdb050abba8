"""From a scene to the numbers: what a scene requires, and its solution."""
