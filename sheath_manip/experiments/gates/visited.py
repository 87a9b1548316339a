"""The states that the policy itself comes to on held-out scenes, and its mistakes there."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.gates.rows import POLICY
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.learning.checkpoint import digest
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.protocols import Environment, Report
from sheath_manip.rollout.request import Crew, EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.task import Task
from sheath_manip.types import (
    Action,
    ActionSpec,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
    Proposal,
    Purpose,
    Reason,
    TaskSpec,
)
from sheath_manip.types.samples import Samples, samples_from


@dataclass(frozen=True, eq=False)
class Visit:
    """One episode of the policy alone, T steps."""

    samples: Samples
    """with the expert's labels"""
    costly: NDArray[np.bool_]
    """(T,) where what the policy did was dear"""
    differs: NDArray[np.bool_]
    """(T,) where it did not do as the expert would, within the task's tolerance"""
    failed: bool


class Judged:
    """The policy drives, whatever it does; the score of a decision is minus its regret."""

    def __init__(self, regret: Callable[[Action], float]) -> None:
        self.regret = regret
        self._driver = AlwaysPolicy(query=True)

    def reset(self, rng: np.random.Generator) -> None:
        """Do nothing: there is nothing to forget."""
        self._driver.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """The policy, judged; the expert only where there is no proposal."""
        decision = self._driver.decide(observation, proposal)
        if proposal is None:
            return decision
        regret = self.regret(proposal.now[0])
        return GateDecision(decision.actor, decision.query, Reason.FIXED, score=-regret)


@dataclass(frozen=True)
class JudgedPolicy:
    """The policy that all gates watch over, alone, with the regret of all that it does."""

    setting: Setting

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Read the policy, and make the expert that judges it."""
        expert, probes = task.expert(environment), self.setting.probes
        gate = Judged(lambda action: probes.regret(expert, action))
        return Crew(gate, self.setting.cloned(environment.spec).policy, expert)


def record_visits(setting: Setting, report: Report) -> None:
    """Let the policy drive alone on the held-out scenes that it has not driven on yet."""
    driver = JudgedPolicy(setting)
    environment = setting.environment()
    environment.close()
    infos = _infos(setting, environment.spec)
    requests = [EpisodeRequest(setting.task, info, driver) for info in infos]
    with SerialExecutor() as executor:
        for _ in executor.map(requests, setting.store(), report=report):
            pass


def visits(setting: Setting) -> list[Visit]:
    """Return what was recorded."""
    stored = setting.store().episodes(Purpose.EVALUATION, POLICY, 0, run_seed=setting.seed)
    costly_regret = setting.probes.costly_regret
    environment = setting.environment()
    environment.close()
    action = environment.spec.action
    return [
        _visit(episode, costly_regret, action) for episode in islice(stored, setting.plan.visited)
    ]


def _visit(episode: Episode, costly_regret: float, action: ActionSpec) -> Visit:
    steps, samples = episode.steps, samples_from([episode])
    wished = np.stack([step.requested for step in steps])
    return Visit(
        samples,
        # A proposal that was no action has no regret: the expert acted.
        np.array([-step.decision.score > costly_regret for step in steps]),
        largest_deviations(action, wished, samples.labels) > action.tolerance,
        episode.outcome is Outcome.FAILURE,
    )


def _infos(setting: Setting, spec: TaskSpec) -> list[EpisodeInfo]:
    variant = setting.learning.schedule.variant
    checkpoint = digest(setting.cloned_path())
    return [
        EpisodeInfo.of(
            spec,
            variant=variant,
            seed=seed,
            purpose=Purpose.EVALUATION,
            method=POLICY,
            index=index,
            run_seed=setting.seed,
            checkpoint=checkpoint,
        )
        for index, seed in enumerate(setting.evaluation_seeds(setting.plan.visited))
    ]
