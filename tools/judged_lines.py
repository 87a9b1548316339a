"""What a step under a gate costs against the policy's look alone: lines of the gate's bench."""

import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.run import LearningRun
from sheath_manip.protocols import Gate
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.tasks.table import STUDIES, TASKS
from sheath_manip.types import Observation, Purpose
from tools.bench import Line, at_most, medians

TAUGHT = {"driving": {"epochs": 1}, "grasp-clutter": {"steps": 20}}
"""by task, how long its policy is trained: what a look costs does not depend on it"""
JUDGED_STATES = 50
"""looked at and judged in a turn"""


def judged_lines(rounds: int, demonstrations: int, held_out: int) -> dict[str, Line]:
    """One step's look and judgement against the look alone, by task.

    Args:
        rounds: in which both take turns.
        demonstrations: that policy and gate are fitted to.
        held_out: expert episodes that the gate is calibrated on.
    """
    lines = {}
    for name in TAUGHT:
        with tempfile.TemporaryDirectory() as folder:
            checkpoint, states, seen = fitted(name, Path(folder), demonstrations, held_out)
        alone, judged = medians(
            partial(act, checkpoint, seen),
            partial(act_and_score, checkpoint, checkpoint.gate(), seen),
            rounds,
        )
        signal = checkpoint.fitted.config.signal
        how = (
            f"{signal}, {states} training states, {1e3 * judged / len(seen):.2f} ms of CPU a step "
            f"against {1e3 * alone / len(seen):.2f}, in turns of {len(seen)} steps"
        )
        lines[f"act and score, {name}"] = at_most(judged / alone, 1.6, "times a bare act", how)
    return lines


def act(checkpoint: Checkpoint, seen: Sequence[Observation]) -> None:
    """Look at each state."""
    for observation in seen:
        checkpoint.policy.propose(observation.alone)


def act_and_score(checkpoint: Checkpoint, gate: Gate, seen: Sequence[Observation]) -> None:
    """Look at each state, and judge what was proposed there."""
    for observation in seen:
        gate.decide(observation, checkpoint.policy.propose(observation.alone))


def fitted(
    name: str, folder: Path, demonstrations: int, held_out: int
) -> tuple[Checkpoint, int, list[Observation]]:
    """Policy and gate of the task's plan `full`, to how many states, and new ones to judge."""
    full = STUDIES[name].plan("full")
    plan = full.changed(
        policy={"settings": {**full.policy.settings, **TAUGHT[name]}},
        schedule={
            "demonstrations": demonstrations,
            "calibration": held_out,
            "false_alarm_episodes": 1,
        },
    )
    store = EpisodeStore.create(folder / "store")
    with SerialExecutor() as executor:
        start = LearningRun(TASKS[name], plan, 0, folder, store, executor).start()
    steps = [step for each in store.episodes(Purpose.CALIBRATION) for step in each.steps]
    chosen = np.linspace(0, len(steps) - 1, JUDGED_STATES).astype(int)
    seen = [steps[place].observation for place in chosen]
    return start.checkpoint, len(start.demonstrations), seen
