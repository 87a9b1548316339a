"""Grasping a target among standing objects without toppling any."""
