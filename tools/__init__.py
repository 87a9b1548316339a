"""Tools for developers and users; each is run as `python -m tools.NAME`."""
