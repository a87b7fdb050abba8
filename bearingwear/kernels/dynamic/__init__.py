"""The motion of balls, inner race and cage in time (theory.md sections 8 and 9)."""
