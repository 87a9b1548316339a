"""Experiments: methods compared, and what is told about them in numbers and figures."""
