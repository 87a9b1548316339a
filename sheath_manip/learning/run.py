"""Rounds of learning from an expert: roll out, append, refit policy and support, calibrate.

The dagger family in one place (Ross et al. 2011; the SHEATH draft, algorithm 1). A method differs
from another by its gate, and by what little else its entry says (`sheath_manip.learning.methods`).
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, attentive_person
from sheath_manip.gates.human import Person
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.checkpoints import Checkpoints
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.evaluation import evaluate_policy
from sheath_manip.learning.methods import METHODS, Method, RoundContext, method_named
from sheath_manip.learning.results import (
    EXPERT,
    RoundListener,
    RoundResult,
    read_result,
    round_path,
    round_results,
    write_result,
)
from sheath_manip.learning.round_metrics import measures_of
from sheath_manip.metrics import EpisodeRecord, expert_share, record_of
from sheath_manip.protocols import Environment, Expert, Gate, Listener, Report
from sheath_manip.rollout.action_noise import DisturbedExpert
from sheath_manip.rollout.collecting import AskedOnce, Recording
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import Episode, Purpose
from sheath_manip.types.samples import Samples, joined, samples_from, visited_from


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
    """of all episodes that the expert drove undisturbed"""


class LearningRun:
    """All rounds of one training seed. Interrupted anywhere, it continues to the same result.

    Episodes lie in `store`; checkpoints and figures of each round under `directory`. What is
    there already is read instead of being made again.
    """

    def __init__(
        self,
        task: Task,
        plan: LearningPlan,
        run_seed: int,
        directory: Path,
        store: EpisodeStore,
        listeners: Sequence[Listener] = (),
        report: Report = lambda _: None,
        person: Callable[[Expert], Person] | None = None,
        supervised: Callable[[Gate], Gate] | None = None,
        demonstrated: Callable[[Gate], Gate] | None = None,
    ) -> None:
        """Make the environment of the run.

        `person` makes the one who may take over; where there is none, one who watches well.
        `supervised` puts another gate around that of each learning episode, and `demonstrated`
        around that of each expert episode before: where the expert is a person at the controls.
        """
        self.task = task
        self.plan = plan
        self.run_seed = run_seed
        self.directory = directory
        self.store = store
        self.listeners = listeners
        self.report = report
        self.environment = task.make_for_run(plan.schedule.variant, run_seed)
        self._supervised = supervised or _as_it_is
        self._demonstrated = demonstrated or _as_it_is
        expert = AskedOnce(task.expert(self.environment))
        action = self.environment.spec.action
        self.person = attentive_person(expert, action) if person is None else person(expert)
        self.disturbed = DisturbedExpert(expert, action, plan.schedule.demonstration_noise)
        self.recording = Recording(self.environment, expert, run_seed, store, listeners, report)
        self.checkpoints = Checkpoints(self.environment.spec, plan, run_seed, directory)

    def close(self) -> None:
        """End the process that writes, and free the simulator."""
        try:
            self.recording.close()
        finally:
            self.environment.close()

    def start(self) -> Common:
        """Collect demonstrations and held-out expert episodes, and fit the first checkpoint."""
        schedule = self.plan.schedule
        demonstrations = self._demonstrations()
        count = schedule.calibration + schedule.false_alarm_episodes
        held_out = self._expert_episodes(Purpose.CALIBRATION, count)
        samples = [samples_from([episode]) for episode in held_out]
        calibration, check = samples[: schedule.calibration], samples[schedule.calibration :]
        states = samples_from(demonstrations)
        # Whom a push made fail says nothing of the expert.
        undisturbed = demonstrations if schedule.demonstration_noise == 0 else []
        records = [record_of(episode) for episode in (*undisturbed, *held_out)]
        checkpoint = self._fitted(self.checkpoints.first(states, calibration), states)
        return Common(checkpoint, states, calibration, check, records)

    def prepare(self) -> Common:
        """Start, and measure what was started with: round 0."""
        common = self.start()
        if not self._path(EXPERT, 0, "json").exists():
            first, states = common.checkpoint, common.demonstrations
            stored = self.store.episodes(Purpose.DEMONSTRATION, EXPERT, 0, self.run_seed)
            measured = self._measured(first, first, common, list(stored), states, states)
            write_result(self._path(EXPERT, 0, "json"), measured)
        return common

    def run(self, method_name: str) -> list[RoundResult]:
        """All rounds of one method; round 0 is the shared start."""
        method = method_named(method_name)
        done = self._finished(method.name)
        if done is not None:
            for result in done:
                self._tell(result)
            return done
        common = self.prepare()
        results = [read_result(self._path(EXPERT, 0, "json"))]
        self._tell(results[0])
        labelled = [common.demonstrations]
        first, calibration = common.checkpoint, common.calibration
        checkpoint = self.checkpoints.begun(method, first, common.demonstrations, calibration)
        while not results[-1].final:
            number = len(results)
            episodes = self._learning_episodes(method, number, checkpoint)
            visited = visited_from(episodes)
            if visited.is_labelled.any():
                labelled.append(visited.labelled())
            aggregated = joined(labelled)
            refitted = self.checkpoints.refitted(
                method, number, checkpoint, aggregated, visited, calibration
            )
            self._fitted(refitted, aggregated)
            path = self._path(method.name, number, "json")
            if not path.exists():
                measured = self._measured(
                    checkpoint, refitted, common, episodes, visited, aggregated
                )
                write_result(path, measured)
            results.append(read_result(path))
            self._tell(results[-1])
            checkpoint = refitted
        return results

    def _tell(self, result: RoundResult) -> None:
        for listener in self.listeners:
            if isinstance(listener, RoundListener):
                listener.on_round(result)

    def _fitted(self, checkpoint: Checkpoint, states: Samples) -> Checkpoint:
        self.report(f"{checkpoint.method} fit {checkpoint.round}")
        for listener in self.listeners:
            listener.on_fit(states)
        return checkpoint

    def _demonstrations(self) -> list[Episode]:
        count = self.plan.schedule.demonstrations
        if self.plan.schedule.demonstration_noise == 0:
            return self._expert_episodes(Purpose.DEMONSTRATION, count)
        gate = partial(AlwaysPolicy, query=True)
        return self.recording.episodes(
            Purpose.DEMONSTRATION, EXPERT, 0, count, gate, self.disturbed
        )

    def _expert_episodes(self, purpose: Purpose, count: int) -> list[Episode]:
        gate = partial(_around, self._demonstrated, AlwaysExpert)
        return self.recording.episodes(purpose, EXPERT, 0, count, gate)

    def _learning_episodes(
        self, method: Method, number: int, checkpoint: Checkpoint
    ) -> list[Episode]:
        context = RoundContext(
            checkpoint=checkpoint,
            round=number,
            reference_share=self._reference_share(method, number),
            plan=method.plan(self.plan),
            person=self.person,
        )
        return self.recording.episodes(
            Purpose.LEARNING,
            method.name,
            number,
            self.plan.schedule.episodes,
            partial(_around, self._supervised, partial(method.gate, context)),
            checkpoint.policy,
            self.checkpoints.digest(checkpoint),
        )

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

    def _measured(
        self,
        driver: Checkpoint,
        fitted: Checkpoint,
        common: Common,
        episodes: Sequence[Episode],
        visited: Samples,
        aggregated: Samples,
    ) -> RoundResult:
        """What the round showed: `driver` drove it, `fitted` was fitted after it."""
        begin = time.perf_counter()
        tolerance = self.environment.spec.action.tolerance
        measures = measures_of(
            episodes, visited, driver, fitted, aggregated, common.check, tolerance
        )
        alone = self._alone(self.environment, fitted, self.plan.comparison.evaluation_episodes)
        final: Sequence[EpisodeRecord] = ()
        if self._is_last(fitted.method, fitted.round, measures.surrogate_loss):
            comparison = self.plan.comparison
            environment = self.task.make_for_run(comparison.final_variant, self.run_seed)
            final = self._alone(environment, fitted, comparison.final_episodes)
            environment.close()
        return RoundResult(
            method=fitted.method,
            run_seed=self.run_seed,
            round=fitted.round,
            checkpoint=self.checkpoints.digest(fitted),
            executed=tuple(record_of(episode) for episode in episodes),
            policy=tuple(alone),
            final=tuple(final),
            false_alarm_rate=measures.false_alarm_rate,
            missed_rate=measures.missed_rate,
            surrogate_loss=measures.surrogate_loss,
            bound=measures.bound,
            threshold=fitted.threshold,
            states=len(aggregated),
            wall_s=time.perf_counter() - begin,
        )

    def _alone(
        self, environment: Environment, checkpoint: Checkpoint, count: int
    ) -> list[EpisodeRecord]:
        """The policy alone, on the same scenes for every method, seed and round."""
        held_out = self.plan.comparison.held_out_set
        seeds = [scene_seed(Purpose.EVALUATION, held_out, index) for index in range(count)]
        return evaluate_policy(environment, checkpoint, seeds, self.report)

    def _is_last(self, method: str, number: int, surrogate_loss: float) -> bool:
        # In round 0 the expert drove; its states say nothing about the policy.
        good_enough = number > 0 and surrogate_loss < self.plan.schedule.stop_below_loss
        return number == self._rounds_of(method) or good_enough

    def _rounds_of(self, method: str) -> int:
        """The plan's rounds, or fewer where the method that this one follows stopped before."""
        follows = METHODS[method].follows if method in METHODS else None
        followed = None if follows is None else self._finished(follows)
        return self.plan.schedule.rounds if followed is None else followed[-1].round

    def _finished(self, method: str) -> list[RoundResult] | None:
        """The rounds of a method that needs no more of them: its last policy has been judged."""
        if not self._path(EXPERT, 0, "json").exists():
            return None
        results = round_results(self.directory, self.run_seed, method)
        return results if results[-1].final else None

    def _path(self, method: str, number: int, suffix: str) -> Path:
        return round_path(self.directory, self.run_seed, method, number, suffix)


def _as_it_is(gate: Gate) -> Gate:
    return gate


def _around(supervised: Callable[[Gate], Gate], make: Callable[[], Gate]) -> Gate:
    return supervised(make())
