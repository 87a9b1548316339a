"""A person's devices: what they say becomes the actions of a robot or of a game."""
