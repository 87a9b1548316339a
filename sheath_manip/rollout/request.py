"""An episode asked for as a value: the unit of work, here, in worker processes, or elsewhere."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Environment, Expert, Gate, Listener, Policy, Report
from sheath_manip.rollout.discarding import until_kept
from sheath_manip.rollout.guard import built
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.watch import Deadline
from sheath_manip.task import HOLD, Task
from sheath_manip.types import Actor, Episode, EpisodeInfo


@dataclass(frozen=True, eq=False)
class Crew:
    """All who may act in an episode, and the gate that says who does."""

    gate: Gate
    policy: Policy | None = None
    expert: Expert | None = None
    others: Mapping[Actor, Expert] = field(default_factory=dict)
    """operator, fallback controller, and the one that holds the robot"""
    deadline: Deadline | None = None
    """of each control step"""
    hindsight_s: float = 0.0
    """time before a failure that the expert labels afterwards"""


class Driver(Protocol):
    """Says as a value what drives an episode: equal drivers make equal crews, in any process.

    Drivers are compared, not hashed.
    """

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Make everyone who may act in `environment`; what is named is read from the disk."""
        ...


@dataclass(frozen=True)
class TimedDriver:
    """Another driver, whose answers have a deadline."""

    driver: Driver
    deadline: Deadline

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Make the other driver's crew."""
        return replace(self.driver.crew(task, environment), deadline=self.deadline)


@dataclass(frozen=True, eq=False)
class EpisodeRequest:
    """One episode of one task, and what drives it. It can be pickled where its driver can."""

    task: Task
    info: EpisodeInfo
    """says which variant of the task; one of its `run_variants` is made for the run"""
    driver: Driver
    begins: NDArray[np.float64] | None = None
    """(s,) a state of that episode, from which it goes on, where not from its start"""


def run_request(
    request: EpisodeRequest,
    environment: Environment,
    crew: Crew,
    listeners: Sequence[Listener] = (),
    report: Report = lambda _: None,
) -> Episode:
    """Run the episode: the one place in which one is started.

    Args:
        request: what is asked for.
        environment: of its task and variant.
        crew: of its driver, for this environment.
        listeners: follow the episode.
        report: is told of attempts that a person discarded.
    """
    attempt = partial(
        rollout,
        environment,
        request.info,
        crew.gate,
        policy=crew.policy,
        expert=crew.expert,
        others=crew.others,
        hold=built(HOLD, request.task.make_hold, environment),
        listeners=listeners,
        deadline=crew.deadline,
        begins=request.begins,
        hindsight_s=crew.hindsight_s,
    )
    return until_kept(attempt, request.info, report)
