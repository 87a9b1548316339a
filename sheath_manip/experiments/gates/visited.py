"""The states that the policy itself comes to on held-out scenes, and its mistakes there."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.recorder import Recorder
from sheath_manip.experiments.gates.rows import POLICY
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.learning.checkpoint import digest
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.protocols import Report
from sheath_manip.rollout.loop import rollout
from sheath_manip.seeding import generator
from sheath_manip.types import (
    Action,
    ActionSpec,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
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
        """Nothing to forget."""
        self._driver.reset(rng)

    def decide(self, observation: Observation, proposed: Action | None) -> GateDecision:
        """The policy, judged; the expert only where `proposed` is None."""
        decision = self._driver.decide(observation, proposed)
        if proposed is None:
            return decision
        regret = self.regret(proposed)
        return GateDecision(decision.actor, decision.query, Reason.FIXED, score=-regret)


def record_visits(setting: Setting, report: Report) -> None:
    """Let the policy drive alone on the held-out scenes that it has not driven on yet."""
    store = setting.store()
    environment = setting.environment()
    expert = setting.task.expert(environment)
    try:
        policy = setting.cloned(environment.spec).policy
        gate = Judged(lambda action: setting.probes.regret(expert, action))
        for info in _infos(setting, environment.spec):
            if not store.has(info):
                rollout(
                    environment,
                    info,
                    gate,
                    rng=generator("none"),
                    policy=policy,
                    expert=expert,
                    listeners=[Recorder(store)],
                )
            report("policy alone")
    finally:
        environment.close()


def visits(setting: Setting) -> list[Visit]:
    """What was recorded."""
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
    wished = np.stack([step.wished for step in steps])
    return Visit(
        samples,
        # A proposal that was no action has no regret: the expert acted.
        np.array([-step.decision.score > costly_regret for step in steps]),
        largest_deviations(action, wished, samples.labels) > action.tolerance,
        episode.outcome is Outcome.FAILURE,
    )


def _infos(setting: Setting, spec: TaskSpec) -> list[EpisodeInfo]:
    checkpoint = digest(setting.cloned_path())
    return [
        EpisodeInfo.of(
            spec,
            variant=setting.learning.variant,
            seed=seed,
            purpose=Purpose.EVALUATION,
            method=POLICY,
            index=index,
            run_seed=setting.seed,
            checkpoint=checkpoint,
        )
        for index, seed in enumerate(setting.evaluation_seeds(setting.plan.visited))
    ]
