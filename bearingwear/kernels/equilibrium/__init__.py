"""Balance of the normal forces of balls and inner race (theory.md sections 2 and 5)."""
