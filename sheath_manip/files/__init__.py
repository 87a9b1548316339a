"""Files: written whole or not at all, and read within bounds, wherever they come from."""
