"""Episodes as other tools have them, before any of these writes them."""

import numpy as np
import pytest

LENGTHS = (4, 6)
STEPS = sum(LENGTHS)


@pytest.fixture
def arrays() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    return {
        # As diffusion_policy's own PushT file has them: bytes told as floats.
        "img": rng.integers(0, 256, (STEPS, 6, 6, 3)).astype(np.float32),
        "state": rng.normal(size=(STEPS, 5)).astype(np.float32),
        "action": rng.normal(size=(STEPS, 2)).astype(np.float32),
        "keypoint": rng.normal(size=(STEPS, 3, 2)),
    }
