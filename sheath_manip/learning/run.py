"""Rounds of learning from an expert: roll out, append, refit policy and support, calibrate.

The dagger family in one place (Ross et al. 2011; the SHEATH draft, algorithm 1). A method differs
from another by its gate, and by what little else its entry says (`sheath_manip.learning.methods`).
"""

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from sheath_manip.counting import announced
from sheath_manip.dataset.aggregated import AggregatedSamples
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.asking import Beside, RunEpisodes
from sheath_manip.learning.beforehand import with_final_variant
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.checkpoints import Checkpoints
from sheath_manip.learning.config import LEAST_CALIBRATION, LearningPlan
from sheath_manip.learning.demonstrations import as_marked, is_learned_from, learned_from
from sheath_manip.learning.drivers import GatedPolicy, PolicyAlone
from sheath_manip.learning.evaluation import Evaluation
from sheath_manip.learning.following import GivenBurdens
from sheath_manip.learning.judged import Judged, Measuring
from sheath_manip.learning.methods import METHODS, Method, method_named
from sheath_manip.learning.results import (
    EXPERT,
    RoundListener,
    RoundResult,
    round_path,
    round_results,
)
from sheath_manip.learning.round_metrics import compute_round_metrics
from sheath_manip.learning.start import SharedStart
from sheath_manip.metrics import record_of
from sheath_manip.protocols import Listener, Report, WorkListener
from sheath_manip.rollout.audience import Audience
from sheath_manip.rollout.executor import Executor, unheard
from sheath_manip.task import Task
from sheath_manip.types import Episode, Outcome, Purpose, TaskSpec
from sheath_manip.types.samples import Samples, samples_from, visited_from


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
        executor: Executor,
        listeners: Sequence[Listener] = (),
        report: Report = unheard,
        supervised: Beside | None = None,
        demonstrated: Beside | None = None,
        failures: bool = False,
        awaits: bool = False,
    ) -> None:
        """Store what is learned, and who runs the episodes.

        `supervised` puts a person beside what drives each learning episode, and `demonstrated`
        beside the expert of those before: where the expert is a person at the controls. With
        `failures` expert episodes that did not succeed are learned from as well; with `awaits` the
        rounds of a method that is followed run in another process, and are waited for.
        """
        self.task = task
        self.plan = with_final_variant(task, plan)
        self.run_seed = run_seed
        self.directory = directory
        self.store = store
        self.executor = executor
        self.listeners = listeners
        self.report = report
        self.spec = _spec_of(task, plan.schedule.variant, run_seed)
        self.episodes = RunEpisodes(
            task,
            plan.schedule,
            self.spec,
            run_seed,
            store,
            executor,
            listeners,
            report,
            supervised,
            demonstrated,
        )
        self.left_out: list[Outcome] = []
        """how the expert episodes ended that were not learned from"""
        self._failures = failures
        self._given = GivenBurdens(self.episodes, directory, store, awaits)

    def start(self) -> SharedStart:
        """Collect demonstrations and held-out expert episodes, and fit the first checkpoint."""
        schedule = self.plan.schedule
        self.left_out.clear()
        demonstrated, held_out = self.episodes.demonstrations(), self.episodes.held_out()
        demonstrations = self._learned_from(list(demonstrated), 1)
        held_out = list(held_out)
        check = [samples_from([each]) for each in held_out[schedule.calibration :]]
        held_out = self._learned_from(held_out[: schedule.calibration], LEAST_CALIBRATION)
        checkpoints = Checkpoints(
            self.spec,
            self.plan,
            self.run_seed,
            self.directory,
            [episode_name(episode.info) for episode in held_out],
            [samples_from([episode]) for episode in held_out],
        )
        states = AggregatedSamples(self.directory).add(samples_from(demonstrations)).samples()
        names = [episode_name(episode.info) for episode in demonstrations]
        with self._working("fitting the first policy"):
            first = checkpoints.first(states, names)
        first = self._fitted(first, states)
        return SharedStart(first, checkpoints, states, names, check)

    def prepare(self) -> SharedStart:
        """Start, and measure what was started with: round 0."""
        start = self.start()
        self._first_judged(start).finished(self.report)
        return start

    def run(self, method_name: str) -> list[RoundResult]:
        """Run all rounds of one method; round 0 is the shared start."""
        method = method_named(method_name)
        done = self._finished(method.name)
        if done is not None:
            for _ in range(self.plan.units_of_run()):
                self.report(f"{method.name} is done")
            for result in done:
                self._tell(result)
            return done
        start = self.start()
        judged, results = self._first_judged(start), list[RoundResult]()
        labelled = AggregatedSamples(self.directory).add(start.demonstrations)
        names = list(start.names)
        checkpoint = start.checkpoints.begun(
            method, start.checkpoint, start.demonstrations, start.names, self._given.of(method, 1)
        )
        ahead = None
        while not judged.last:
            if not self.executor.overlaps:
                self._finish(judged, results)
            number = judged.number + 1
            episodes = list(ahead or self._learning_episodes(start, method, number, checkpoint))
            visited = visited_from(as_marked(episodes, self.store))
            if visited.is_labelled.any():
                labelled.add(visited.labelled())
                names += [episode_name(each.info) for each in episodes if _is_labelled(each)]
            aggregated = labelled.samples()
            with self._working(f"fitting round {number}"):
                refitted = start.checkpoints.refitted(
                    method,
                    number,
                    checkpoint,
                    aggregated,
                    visited,
                    names,
                    self.given(method, number + 1),
                )
            self._fitted(refitted, aggregated)
            # They run while this round is measured.
            more = self._surely_goes_on(method.name, number)
            ahead = self._learning_episodes(start, method, number + 1, refitted) if more else None
            if self.executor.overlaps:
                # That policy was alone on its scenes while this round was collected and fitted to.
                self._finish(judged, results)
            judged = self._judged(start, checkpoint, refitted, episodes, len(aggregated))
            checkpoint = refitted
        self._finish(judged, results)
        return results

    def given(self, method: Method, number: int) -> Mapping[str, Any]:
        """Return the gate's settings of a round, or the last, that another method's rounds say."""
        return self._given.of(method, min(number, self._rounds_of(method.name)))

    def _finish(self, judged: Judged, results: list[RoundResult]) -> None:
        with self._working(f"trying the policy of round {judged.number} alone"):
            results.append(judged.finished(self.report))
        self._tell(results[-1])

    def _tell(self, result: RoundResult) -> None:
        followers = [one for one in self.listeners if isinstance(one, RoundListener)]
        Audience(followers).tell(lambda listener: listener.on_round(result))

    def _working(self, what: str) -> AbstractContextManager[None]:
        """Say to all who want to know what is done, and how far it is, until the block ends."""
        followers = [one for one in self.listeners if isinstance(one, WorkListener)]
        audience = Audience(followers)
        return announced(what, lambda work: audience.tell(lambda each: each.on_work(work)))

    def _fitted(self, checkpoint: Checkpoint, states: Samples) -> Checkpoint:
        self.report(f"{checkpoint.method} fit {checkpoint.round}")
        Audience(self.listeners).fit(states)
        return checkpoint

    def _learned_from(self, episodes: Sequence[Episode], least: int) -> list[Episode]:
        # With noise on its actions it was the noise that failed.
        failures = self._failures or self.plan.schedule.demonstration_noise > 0
        taken, left_out = learned_from(episodes, self.store, failures, least)
        self.left_out += left_out
        return taken

    def _learning_episodes(
        self, start: SharedStart, method: Method, number: int, checkpoint: Checkpoint
    ) -> Iterator[Episode]:
        checkpoints = start.checkpoints
        digest = checkpoints.digest(checkpoint)
        driver = GatedPolicy(checkpoints.path(checkpoint), digest)
        return self.episodes.of_round(method.name, number, driver, digest)

    def _first_judged(self, start: SharedStart) -> Judged:
        stored = self.store.episodes(Purpose.DEMONSTRATION, EXPERT, 0, self.run_seed)
        # All that the expert brought to an end, also what is not learned from.
        shown = (each for each in stored if is_learned_from(each.info.purpose, each.outcome, True))
        first, states = start.checkpoint, len(start.demonstrations)
        return self._judged(start, first, first, shown, states)

    def _judged(
        self,
        start: SharedStart,
        driver: Checkpoint,
        fitted: Checkpoint,
        episodes: Iterable[Episode],
        states: int,
    ) -> Judged:
        """What the round showed: `driver` drove it, `fitted` was fitted after it to `states`."""
        path = self._path(fitted.method, fitted.round, "json")
        if path.exists():
            return Judged.before(path)
        begin_s, digest = time.perf_counter(), start.checkpoints.digest(fitted)
        evaluation = Evaluation(self.task, self.plan, self.spec, self.executor, self.report)
        alone = PolicyAlone(start.checkpoints.path(fitted), digest)
        policy = evaluation.of(alone, fitted)
        episodes = list(episodes)
        tolerance = self.spec.action.tolerance
        metrics = compute_round_metrics(episodes, driver, fitted, start.check, tolerance)
        last = self._is_last(fitted.method, fitted.round, metrics.surrogate_loss)
        measured = RoundResult(
            method=fitted.method,
            run_seed=self.run_seed,
            round=fitted.round,
            checkpoint=digest,
            executed=tuple(record_of(episode) for episode in episodes),
            policy=(),
            final=(),
            false_alarm_rate=metrics.false_alarm_rate,
            missed_rate=metrics.missed_rate,
            surrogate_loss=metrics.surrogate_loss,
            bound=metrics.bound,
            threshold=fitted.threshold,
            states=states,
            wall_s=0.0,
        )
        final = evaluation.of(alone, fitted, final=True) if last else ()
        return Judged(path, fitted.round, last, Measuring(measured, begin_s, policy, final))

    def _is_last(self, method: str, number: int, surrogate_loss: float) -> bool:
        # In round 0 the expert drove; its states say nothing about the policy.
        ends = number > 0 and surrogate_loss < self.plan.schedule.stop_below_loss
        return ends or number == self._rounds_of(method)

    def _surely_goes_on(self, method: str, number: int) -> bool:
        """Whether a round follows, whatever this one shows, and runs as soon as it is asked for."""
        known = self.plan.rounds_are_known and self.executor.overlaps
        return known and number < self._rounds_of(method)

    def _rounds_of(self, method: str) -> int:
        """The plan's rounds, or fewer where the method that this one follows stopped before."""
        follows = METHODS[method].burden_from if method in METHODS else None
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


def _is_labelled(episode: Episode) -> bool:
    return any(step.label is not None for step in episode.steps)


def _spec_of(task: Task, variant: str, run_seed: int) -> TaskSpec:
    environment = task.make_for_run(variant, run_seed)
    environment.close()
    return environment.spec
