"""The steady state of a ball between worn grooves (theory.md sections 17 and 21)."""
