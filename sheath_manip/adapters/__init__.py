"""Doors to what others have: environments, policies, data."""
