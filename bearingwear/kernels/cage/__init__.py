"""The cage: its body and its contacts with balls and land (theory.md section 10)."""
