"""A checkpoint whose gate notices that nothing goes on."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.progress import Progress, ProgressGate
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from tests.blobs import SPEC
from tests.learning.test_checkpoint import checkpoint_of


@pytest.fixture(scope="module")
def checkpoint() -> Checkpoint:
    return checkpoint_of("hog-svm", "pixels")


def test_what_notices_that_nothing_goes_on_comes_back(
    checkpoint: Checkpoint, tmp_path: Path
) -> None:
    config = replace(checkpoint.fitted.config, stuck_steps=4)
    walks = [np.cumsum(np.ones((12, 1)), axis=0), np.cumsum(np.full((9, 1), 0.5), axis=0)]
    progress = Progress.of(walks, 4)
    fitted = replace(checkpoint.fitted, config=config, progress=progress)
    loaded = load_checkpoint(replace(checkpoint, fitted=fitted).save(tmp_path / "c.npz"), SPEC)
    assert loaded.fitted.progress is not None
    assert loaded.fitted.progress.least == progress.least
    assert isinstance(loaded.gate(), ProgressGate)


def test_a_gate_that_judges_by_nothing_watches_nothing_either(
    checkpoint: Checkpoint, tmp_path: Path
) -> None:
    # Random takeover under a plan whose other gates notice it.
    config = replace(checkpoint.fitted.config, kind="random-takeover", stuck_steps=4)
    fitted = FittedGate(config, checkpoint.policy)
    loaded = load_checkpoint(replace(checkpoint, fitted=fitted).save(tmp_path / "c.npz"), SPEC)
    assert loaded.fitted.progress is None
    assert not isinstance(loaded.gate(), ProgressGate)
