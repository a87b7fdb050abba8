"""The solution of a scene: its model, its states and its numbers."""
