"""Spoiled checkpoints: each is refused in one line that names it, or drives as the sound one.

The last kind is the file of a gate alone, whose policy is kept elsewhere.
"""

import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np

from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.exceptions import CheckpointError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.external import External
from sheath_manip.learning.gate_file import ExternalGate, load_gate
from sheath_manip.learning.loop_gate import LoopGate
from sheath_manip.policies import make_policy
from sheath_manip.signals import make_signal
from sheath_manip.support.config import SupportConfig
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples
from tests.faults.checkpoint_ways import WAYS, Spoil
from tests.faults.counting import Count, Verdict, counted
from tests.looks import fitted_signal, measures_of

MOST_S = 10.0
"""for one file, on a busy machine"""
OF_EACH = 30
"""files spoiled in each way; a few where it must be quick"""
QUICK = 2
SIDE_PX = 40


@dataclass(frozen=True)
class Kind:
    """A policy and what its gate looks at."""

    policy: str
    settings: Mapping[str, Any]
    signal: str
    embedding: str


KINDS = (
    Kind("linear-svm", {"penalty": 0.1}, "joined", "features"),
    Kind("cnn", {"channels": (4,), "hidden": (8,), "epochs": 1}, "support", "pooled-convolutions"),
    Kind("hog-svm", {"side": 24, "cell": 8}, "trust", "pixels"),
)
ALONE = len(KINDS)
"""the number of the kind that is a gate alone"""
CHOICES = np.array([[0, 0], [1, 0], [0, 1]], np.float32)
ACTION = ActionSpec(("left", "right"), CHOICES[0], np.ones(2, np.float32), CHOICES)
SPEC = TaskSpec("spoiled", 10.0, ACTION, {"top": (SIDE_PX, SIDE_PX)}, ("a", "b", "c"), 100, "steps")


def samples(count: int, seed: int) -> Samples:
    rng = np.random.default_rng(seed)
    images = rng.integers(0, 256, (count, SIDE_PX, SIDE_PX, 3), dtype=np.uint8)
    labels = CHOICES[rng.integers(3, size=count)]
    features = rng.normal(size=(count, 3)).astype(np.float32)
    return Samples({"top": images}, features, labels, np.arange(count) // 20)


@cache
def checkpoint(kind: int) -> Checkpoint:
    """A sound one, fitted once."""
    states, chosen = samples(60, 0), KINDS[kind]
    policy = make_policy(chosen.policy, SPEC, **chosen.settings).fit(states)
    config = GateConfig(
        signal=chosen.signal,
        embedding=chosen.embedding,
        precedent_embedding=chosen.embedding,
        support=SupportConfig(nu=0.3),
    )
    signal = fitted_signal(make_signal(planned_signal(config)), policy, states)
    signal.calibrate([measures_of(signal, policy, samples(40, 1))])
    fitted = FittedGate(config, policy, signal, -0.01, 0.0, Sources(("a",), ("b",)))
    return Checkpoint(SPEC.name, chosen.policy, policy, fitted, "sheath", 1, 0, 0.5)


@cache
def gate_alone() -> ExternalGate:
    """That of the first kind, whose policy is not saved along."""
    external = External("mine.py:act", "runs/demos", RecordedSpec.of_task(SPEC))
    return ExternalGate(checkpoint(0).fitted, external)


def saved(kind: int, path: Path) -> Path:
    return (gate_alone() if kind == ALONE else checkpoint(kind)).save(path)


def loaded(kind: int, path: Path) -> Checkpoint | LoopGate:
    return load_gate(path, checkpoint(0).policy) if kind == ALONE else load_checkpoint(path, SPEC)


def says(held: Checkpoint | LoopGate) -> list[object]:
    """All that decides who acts and how, in a few states."""
    seen = samples(5, 2)
    fitted = held.fitted
    if isinstance(held, LoopGate):
        spec = RecordedSpec.of_task(held.spec)
        settings = (fitted.config, fitted.threshold, fitted.release_margin, fitted.sources)
        return [spec, settings, fitted.scores(seen).tobytes()]
    facts = replace(held, policy=None, fitted=None, remark="", training_loss=0.0)  # pyright: ignore
    settings = (fitted.config, fitted.threshold, fitted.release_margin, fitted.sources)
    actions = held.policy.predict(seen.observations).actions
    return [vars(facts), settings, actions.tobytes(), fitted.scores(seen).tobytes()]


@cache
def sound(kind: int) -> list[object]:
    """What a file that nobody has touched says."""
    with tempfile.TemporaryDirectory() as folder:
        return says(loaded(kind, saved(kind, Path(folder) / "sound.npz")))


def verdict(folder: Path, way: str, spoil: Spoil, number: int) -> Verdict:
    """Spoil a file, read it, and see what came of it."""
    rng = np.random.default_rng([number, crc32(way.encode())])
    kind = int(rng.integers(len(KINDS) + 1))
    path = saved(kind, folder / f"{number}.npz")
    spoil(path, rng)
    began_s = time.monotonic()
    try:
        same = says(loaded(kind, path)) == sound(kind)
        survived, came = same, "the same" if same else "silently another"
    except CheckpointError as error:
        line = str(error)
        survived, came = "\n" not in line and str(path) in line and len(line) < 1500, line
    except Exception as error:
        survived, came = False, f"{type(error).__name__}: {error}"
    took_s = time.monotonic() - began_s
    survived &= took_s < MOST_S
    told = survived
    return Verdict(way, survived, told, f"{way} {number}, {took_s:.1f} s: {came[:300]}")


def verdicts(of_each: int, ways: Mapping[str, Spoil] = WAYS) -> Iterator[Verdict]:
    """Spoil so many files in each way."""
    for way, spoil in ways.items():
        for number in range(of_each):
            with tempfile.TemporaryDirectory() as folder:
                yield verdict(Path(folder), way, spoil, number)


def counts(quick: bool) -> Mapping[str, Count]:
    """Return what became of all files, by the way in which they were spoiled."""
    return counted(verdicts(QUICK if quick else OF_EACH))
