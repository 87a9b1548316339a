"""What `python -m tools.make_docs` makes pages from: numbers, verbs, templates."""
