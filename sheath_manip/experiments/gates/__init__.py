"""The benchmark of gates: which notices what, which foresees failures, which saves them."""
