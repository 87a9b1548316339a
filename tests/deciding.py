"""What the gates that are made from a checkpoint decide, for tests that they are one."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from sheath_manip.cli.adjusting import adjusted
from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.protocols import Environment, Restorable
from sheath_manip.rollout import serial
from sheath_manip.rollout.discarding import draws_of
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.task import Task
from sheath_manip.types import Episode, GateDecision


def told(decision: GateDecision) -> tuple:
    """All of it, as what can be compared: NaN is NaN."""
    return (
        decision.actor,
        decision.query,
        decision.reason,
        *(repr(float(number)) for number in (decision.score, decision.threshold)),
    )


def recorded(episode: Episode) -> list[tuple]:
    return [told(step.decision) for step in episode.steps]


def decided(driver: Driver, task: Task, environment: Environment, episode: Episode) -> list[tuple]:
    """What the driver's gate says of the recorded observations, asked as the loop asks it."""
    crew = driver.crew(task, environment)
    assert crew.policy is not None
    assert isinstance(environment, Restorable)
    environment.reset(episode.info.seed)
    rng = draws_of(episode.info)
    crew.policy.reset(rng.spawn(1)[0])
    crew.gate.reset(rng)
    said = []
    for step in episode.steps:
        # A person who watches knows what the expert would do, which looks at the physics.
        environment.restore(step.state)
        proposal = crew.policy.propose(step.observation.alone)
        said.append(told(crew.gate.decide(step.observation, proposal)))
    return said


def of_the_run(task: Task, path: Path, patch: pytest.MonkeyPatch) -> Driver:
    """What `sheath run` lets drive; nothing is run."""
    asked: list[EpisodeRequest] = []

    class Asked(SerialExecutor):
        def map(self, requests, *others, **options) -> Iterator[Episode]:  # noqa: ARG002
            asked.extend(requests)
            yield from ()

    argv = ["run", task.name, "--checkpoint", str(path), "--episodes", "1"]
    with patch.context() as patched:
        patched.setattr(serial, "SerialExecutor", Asked)
        assert run_command(lambda: Catalog({task.name: task}, {}), argv) == 0
    return asked[0].driver


def of_the_page(path: Path, environment: Environment) -> Driver:
    """What a page with sliders lets drive."""
    checkpoint = load_checkpoint(path, environment.spec)
    return adjusted(path, checkpoint, None, environment.spec).driver
