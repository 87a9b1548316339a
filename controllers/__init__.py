"""Experts and command filters."""
