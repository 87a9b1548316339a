"""Tasks that others wrote, and what was learned on them."""
