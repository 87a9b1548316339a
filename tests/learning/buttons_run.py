"""Every method's rounds of learning on the toy task of buttons."""

from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.methods import METHODS
from sheath_manip.learning.results import RoundResult
from sheath_manip.learning.run import LearningRun
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.types import Episode
from tests.buttons import BUTTONS, PLAN

# What is followed comes first.
ORDER = sorted(METHODS, key=lambda name: METHODS[name].burden_from is not None)


def run(
    method: str, directory: Path, plan: LearningPlan = PLAN, seed: int = 0, **options
) -> list[RoundResult]:
    store = EpisodeStore.create(directory / "store")
    with SerialExecutor() as executor:
        return LearningRun(BUTTONS, plan, seed, directory, store, executor, **options).run(method)


def uninterrupted(factory: pytest.TempPathFactory) -> Path:
    """All methods from one seed, never interrupted, run once for all files that read them."""
    directory = factory.getbasetemp() / "whole-buttons"
    if not directory.exists():
        for name in ORDER:
            run(name, directory)
    return directory


def episodes(directory: Path, method: str, number: int | None = None) -> list[Episode]:
    return list(EpisodeStore(directory / "store").episodes(method=method, round=number))
