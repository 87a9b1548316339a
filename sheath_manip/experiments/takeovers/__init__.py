"""Which gate calls for the expert where it counts: every gate beside baselines of equal burden."""
