"""Arms and tools, as any task may use them."""
