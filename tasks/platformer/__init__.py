"""A run and jump game after Super Mario: gaps, steps, pipes and enemies up to a flag."""
