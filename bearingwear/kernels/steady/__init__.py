"""The steady state of a ball under thrust: friction balanced (theory.md section 4)."""
