"""Rounds of learning from an expert: roll out, append, refit policy and support, calibrate.

The dagger family in one place (Ross et al. 2011; the SHEATH draft, algorithm 1). A method differs
from another only by its gate (`sheath_manip.methods`).
"""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from sheath_manip import theory
from sheath_manip.checkpoint import Checkpoint, digest, load_checkpoint
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.samples import Samples, joined, samples_from
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.evaluation import Report, evaluate_policy
from sheath_manip.exceptions import ParameterError
from sheath_manip.fitting import fit_gate
from sheath_manip.gates.constant import AlwaysExpert
from sheath_manip.methods import METHODS, Method, RoundContext, method_named
from sheath_manip.metrics import EpisodeRecord, expert_share, record_of
from sheath_manip.plan import LearningPlan
from sheath_manip.policies import make_policy
from sheath_manip.policies.agreement import held_out_agreement
from sheath_manip.protocols import Gate, Listener, Policy
from sheath_manip.results import (
    EXPERT,
    RoundResult,
    read_result,
    round_path,
    round_results,
    write_result,
)
from sheath_manip.rollout import rollout
from sheath_manip.seeding import generator, scene_seed, seed_for
from sheath_manip.task import TaskEntry
from sheath_manip.types import Actor, Episode, EpisodeInfo, Purpose


@dataclass(frozen=True, eq=False)
class Common:
    """What all methods of one training seed share: they start from the same policy."""

    checkpoint: Checkpoint
    demonstrations: Samples
    calibration: Sequence[Samples]
    """one a held-out expert episode, for the threshold"""
    check: Sequence[Samples]
    """one a further held-out expert episode, for measuring false alarms"""
    records: Sequence[EpisodeRecord]
    """of all expert episodes"""


class LearningRun:
    """All rounds of one training seed. Interrupted anywhere, it continues to the same result.

    Episodes lie in `store`; checkpoints and figures of each round under `directory`. What is
    there already is read instead of being made again.
    """

    def __init__(
        self,
        task: TaskEntry,
        plan: LearningPlan,
        run_seed: int,
        directory: Path,
        store: EpisodeStore,
        listeners: Sequence[Listener] = (),
        report: Report = lambda _: None,
    ) -> None:
        self.task = task
        self.plan = plan
        self.run_seed = run_seed
        self.directory = directory / f"s{run_seed}"
        self.store = store
        self.listeners = listeners
        self.report = report
        self.environment = task.make()
        self.expert = task.expert(self.environment)

    def close(self) -> None:
        """Free the simulator."""
        self.environment.close()

    def start(self) -> Common:
        """Collect demonstrations and held-out expert episodes, and fit the first checkpoint."""
        plan = self.plan
        demonstrations = self._expert_episodes(Purpose.DEMONSTRATION, plan.demonstrations)
        held_out = self._expert_episodes(Purpose.CALIBRATION, plan.calibration + plan.check)
        samples = [samples_from([episode]) for episode in held_out]
        calibration, check = samples[: plan.calibration], samples[plan.calibration :]
        states = samples_from(demonstrations)
        records = [record_of(episode) for episode in (*demonstrations, *held_out)]
        checkpoint = self._checkpoint(EXPERT, 0, None, states, calibration)
        return Common(checkpoint, states, calibration, check, records)

    def prepare(self) -> Common:
        """Start, and measure what was started with: round 0."""
        common = self.start()
        if not self._path(EXPERT, 0, "json").exists():
            first, states = common.checkpoint, common.demonstrations
            stored = self.store.episodes(Purpose.DEMONSTRATION, EXPERT, 0, self.run_seed)
            measured = self._measured(first, common, list(stored), states, first)
            write_result(self._path(EXPERT, 0, "json"), measured)
        return common

    def run(self, method_name: str) -> list[RoundResult]:
        """All rounds of one method; round 0 is the shared start."""
        method = method_named(method_name)
        done = self._finished(method.name)
        if done is not None:
            return done
        common = self.prepare()
        start = read_result(self._path(EXPERT, 0, "json"))
        results = [start]
        states = [common.demonstrations]
        checkpoint = common.checkpoint
        while not results[-1].final:
            number = len(results)
            episodes = self._learning_episodes(method, number, checkpoint)
            states.append(samples_from(episodes))
            path = self._path(method.name, number, "json")
            aggregated = joined(states)
            refitted = self._checkpoint(
                method.name, number, checkpoint, aggregated, common.calibration, states[-1]
            )
            if not path.exists():
                measured = self._measured(refitted, common, episodes, aggregated, checkpoint)
                write_result(path, measured)
            results.append(read_result(path))
            checkpoint = refitted
        return results

    def _is_last(self, method: str, number: int, surrogate_loss: float) -> bool:
        # In round 0 the expert drove; its states say nothing about the policy.
        good_enough = number > 0 and surrogate_loss < self.plan.stop_below_loss
        return number == self._rounds_of(method) or good_enough

    def _rounds_of(self, method: str) -> int:
        """The plan's rounds, or fewer where the method that this one follows stopped before."""
        follows = METHODS[method].follows if method in METHODS else None
        followed = None if follows is None else self._finished(follows)
        return self.plan.rounds if followed is None else followed[-1].round

    def _finished(self, method: str) -> list[RoundResult] | None:
        """The rounds of a method that needs no more of them: its last policy has been judged."""
        if not self._path(EXPERT, 0, "json").exists():
            return None
        results = round_results(self.directory.parent, self.run_seed, method)
        return results if results[-1].final else None

    def _expert_episodes(self, purpose: Purpose, count: int) -> list[Episode]:
        infos = [self._info(purpose, EXPERT, 0, index) for index in range(count)]
        return list(self._recorded(infos, lambda: AlwaysExpert(), None))

    def _learning_episodes(
        self, method: Method, number: int, checkpoint: Checkpoint
    ) -> list[Episode]:
        context = RoundContext(checkpoint, number, self._reference_share(method, number), self.plan)
        infos = [
            replace(
                self._info(Purpose.LEARNING, method.name, number, index),
                checkpoint=self._digest(checkpoint),
            )
            for index in range(self.plan.episodes)
        ]
        return list(self._recorded(infos, lambda: method.gate(context), checkpoint.policy))

    def _reference_share(self, method: Method, number: int) -> float:
        if method.follows is None:
            return float("nan")
        path = self._path(method.follows, number, "json")
        if not path.exists():
            raise ParameterError(
                f"{method.name} is given the expert share of {method.follows}, which has no round "
                f"{number} for seed {self.run_seed} yet; run {method.follows} first"
            )
        return expert_share(read_result(path).executed)

    def _recorded(
        self, infos: Iterable[EpisodeInfo], gate: Callable[[], Gate], policy: Policy | None
    ) -> Iterable[Episode]:
        """Each episode from the store, or run and recorded now."""
        listeners = (Recorder(self.store), *self.listeners)
        for info in infos:
            if self.store.has(info):
                yield self.store.read(episode_name(info))
            else:
                yield rollout(
                    self.environment,
                    info,
                    gate(),
                    rng=generator("gate", info.method, info.run_seed, info.round, info.index),
                    policy=policy,
                    expert=self.expert,
                    listeners=listeners,
                )
            self.report(f"{info.method} round {info.round}")

    def _checkpoint(
        self,
        method: str,
        number: int,
        previous: Checkpoint | None,
        states: Samples,
        calibration: Sequence[Samples],
        visited: Samples | None = None,
    ) -> Checkpoint:
        """Read the round's checkpoint, or fit policy (warm), signal and threshold."""
        path = self._path(method, number, "npz")
        spec = self.environment.spec
        if path.exists():
            return self._fitted(load_checkpoint(path, spec), states)
        plan = self.plan

        def fresh_policy() -> Policy:
            return make_policy(plan.policy, spec, seed_for("policy", self.run_seed))

        policy = fresh_policy()
        if previous is not None:
            policy.load(previous.policy.arrays())
        policy.fit(states)
        checkpoint = fit_gate(
            policy,
            states,
            calibration,
            plan,
            spec.name,
            agreement=partial(held_out_agreement, fresh_policy, states),
            previous=previous,
            visited=visited,
        )
        checkpoint = replace(checkpoint, method=method, round=number, run_seed=self.run_seed)
        checkpoint.save(path)
        # Read back, so that a resumed run continues from the same bits as an uninterrupted one.
        return self._fitted(load_checkpoint(path, spec), states)

    def _fitted(self, checkpoint: Checkpoint, states: Samples) -> Checkpoint:
        self.report(f"{checkpoint.method} fit {checkpoint.round}")
        for listener in self.listeners:
            listener.on_fit(states)
        return checkpoint

    def _measured(
        self,
        checkpoint: Checkpoint,
        common: Common,
        episodes: Sequence[Episode],
        aggregated: Samples,
        driver: Checkpoint,
    ) -> RoundResult:
        """What the round showed: `driver` drove it, `checkpoint` was fitted after it."""
        begin = time.perf_counter()
        visited = samples_from(episodes)
        losses = driver.policy.surrogate_losses(visited)
        acted = np.concatenate(
            [[step.decision.actor is Actor.POLICY for step in e.steps if step.labelled is not None]
             for e in episodes]
        )  # fmt: skip
        epsilon = float(np.mean(checkpoint.policy.surrogate_losses(aggregated)))
        scores = driver.scores(visited)
        bound = theory.measure(episodes, scores, driver.threshold, losses, epsilon)
        alarms = [
            float(np.mean(~(checkpoint.scores(one) >= checkpoint.threshold)))
            for one in common.check
        ]
        alone = evaluate_policy(
            self.environment, checkpoint, self._held_out(self.plan.held_out), self.report
        )
        surrogate_loss = float(np.mean(losses))
        final: Sequence[EpisodeRecord] = ()
        if self._is_last(checkpoint.method, checkpoint.round, surrogate_loss):
            environment = self.task.make("final")
            final = evaluate_policy(
                environment, checkpoint, self._held_out(self.plan.final), self.report
            )
            environment.close()
        return RoundResult(
            method=checkpoint.method,
            run_seed=self.run_seed,
            round=checkpoint.round,
            checkpoint=self._digest(checkpoint),
            executed=tuple(record_of(episode) for episode in episodes),
            policy=tuple(alone),
            final=tuple(final),
            false_alarm_rate=float(np.mean(alarms)),
            missed_rate=float(acted[losses > 0].mean()) if (losses > 0).any() else 0.0,
            surrogate_loss=surrogate_loss,
            bound=bound,
            threshold=checkpoint.threshold,
            states=len(aggregated),
            wall_s=time.perf_counter() - begin,
        )

    def _held_out(self, count: int) -> list[int]:
        """The same scenes for every method, seed and round."""
        return [scene_seed(Purpose.EVALUATION, self.plan.held_out_set, i) for i in range(count)]

    def _info(self, purpose: Purpose, method: str, number: int, index: int) -> EpisodeInfo:
        spec = self.environment.spec
        return EpisodeInfo(
            task=spec.name,
            # Not by method: all methods meet the same scenes in the same round.
            seed=scene_seed(purpose, self.run_seed, number, index),
            purpose=purpose,
            control_rate_hz=spec.control_rate_hz,
            method=method,
            round=number,
            index=index,
            run_seed=self.run_seed,
        )

    def _digest(self, checkpoint: Checkpoint) -> str:
        return digest(self._path(checkpoint.method, checkpoint.round, "npz"))

    def _path(self, method: str, number: int, suffix: str) -> Path:
        return round_path(self.directory.parent, self.run_seed, method, number, suffix)
