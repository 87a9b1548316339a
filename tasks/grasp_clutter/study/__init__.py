"""Grasping in clutter as an experiment: its plans, probes, figures and claims."""
