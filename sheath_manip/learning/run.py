"""Rounds of learning from an expert: roll out, append, refit policy and support, calibrate.

The dagger family in one place (Ross et al. 2011; the SHEATH draft, algorithm 1). A method differs
from another by its gate, and by what little else its entry says (`sheath_manip.learning.methods`).
"""

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.checkpoints import Checkpoints
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.drivers import ExpertAlone, GatedPolicy, NoisyExpert, PolicyAlone
from sheath_manip.learning.evaluation import Evaluation
from sheath_manip.learning.methods import METHODS, Method, method_named
from sheath_manip.learning.results import (
    EXPERT,
    RoundListener,
    RoundResult,
    read_result,
    round_path,
    round_results,
    write_result,
)
from sheath_manip.learning.round_metrics import compute_round_metrics
from sheath_manip.learning.start import SharedStart
from sheath_manip.metrics import expert_share, record_of
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.audience import Audience
from sheath_manip.rollout.executor import Executor, unheard
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import Episode, EpisodeInfo, Purpose, TaskSpec
from sheath_manip.types.samples import Samples, joined, samples_from, visited_from


def _as_it_is(driver: Driver) -> Driver:
    return driver


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
        supervised: Callable[[Driver], Driver] = _as_it_is,
        demonstrated: Callable[[Driver], Driver] = _as_it_is,
    ) -> None:
        """Store what is learned, and who runs the episodes.

        `supervised` puts a person beside what drives each learning episode, and `demonstrated`
        beside the expert of those before: where the expert is a person at the controls.
        """
        self.task = task
        self.plan = plan
        self.run_seed = run_seed
        self.directory = directory
        self.store = store
        self.executor = executor
        self.listeners = listeners
        self.report = report
        self.spec = _spec_of(task, plan.schedule.variant, run_seed)
        self._supervised = supervised
        self._demonstrated = demonstrated

    def start(self) -> SharedStart:
        """Collect demonstrations and held-out expert episodes, and fit the first checkpoint."""
        schedule = self.plan.schedule
        demonstrations = self._demonstrations()
        count = schedule.calibration + schedule.false_alarm_episodes
        held_out = self._expert_episodes(Purpose.CALIBRATION, count)
        samples = [samples_from([episode]) for episode in held_out]
        names = [episode_name(episode.info) for episode in held_out]
        checkpoints = Checkpoints(
            self.spec,
            self.plan,
            self.run_seed,
            self.directory,
            names[: schedule.calibration],
            samples[: schedule.calibration],
        )
        states = samples_from(demonstrations)
        learned_from = [episode_name(episode.info) for episode in demonstrations]
        first = self._fitted(checkpoints.first(states, learned_from), states)
        check = samples[schedule.calibration :]
        return SharedStart(first, checkpoints, states, learned_from, check)

    def prepare(self) -> SharedStart:
        """Start, and measure what was started with: round 0."""
        start = self.start()
        if not self._path(EXPERT, 0, "json").exists():
            stored = self.store.episodes(Purpose.DEMONSTRATION, EXPERT, 0, self.run_seed)
            first, states = start.checkpoint, len(start.demonstrations)
            measured = self._shown(start, first, first, list(stored), states)
            write_result(self._path(EXPERT, 0, "json"), measured)
        return start

    def run(self, method_name: str) -> list[RoundResult]:
        """Run all rounds of one method; round 0 is the shared start."""
        method = method_named(method_name)
        done = self._finished(method.name)
        if done is not None:
            for result in done:
                self._tell(result)
            return done
        start = self.prepare()
        results = [read_result(self._path(EXPERT, 0, "json"))]
        self._tell(results[0])
        labelled, names = [start.demonstrations], list(start.names)
        checkpoint = start.checkpoints.begun(
            method, start.checkpoint, start.demonstrations, start.names, self._share(method, 1)
        )
        while not results[-1].final:
            number = len(results)
            episodes = self._learning_episodes(start, method, number, checkpoint)
            visited = visited_from(episodes)
            if visited.is_labelled.any():
                labelled.append(visited.labelled())
                names += [episode_name(each.info) for each in episodes if _is_labelled(each)]
            aggregated = joined(labelled)
            refitted = start.checkpoints.refitted(
                method,
                number,
                checkpoint,
                aggregated,
                visited,
                names,
                self._share(method, min(number + 1, self._rounds_of(method.name))),
            )
            self._fitted(refitted, aggregated)
            path = self._path(method.name, number, "json")
            if not path.exists():
                measured = self._shown(start, checkpoint, refitted, episodes, len(aggregated))
                write_result(path, measured)
            results.append(read_result(path))
            self._tell(results[-1])
            checkpoint = refitted
        return results

    def _tell(self, result: RoundResult) -> None:
        followers = [one for one in self.listeners if isinstance(one, RoundListener)]
        Audience(followers).tell(lambda listener: listener.on_round(result))

    def _fitted(self, checkpoint: Checkpoint, states: Samples) -> Checkpoint:
        self.report(f"{checkpoint.method} fit {checkpoint.round}")
        Audience(self.listeners).fit(states)
        return checkpoint

    def _demonstrations(self) -> list[Episode]:
        schedule = self.plan.schedule
        if schedule.demonstration_noise == 0:
            return self._expert_episodes(Purpose.DEMONSTRATION, schedule.demonstrations)
        driver = NoisyExpert(schedule.demonstration_noise)
        return self._episodes(Purpose.DEMONSTRATION, EXPERT, 0, schedule.demonstrations, driver)

    def _expert_episodes(self, purpose: Purpose, count: int) -> list[Episode]:
        driver = self._demonstrated(ExpertAlone())
        return self._episodes(purpose, EXPERT, 0, count, driver)

    def _learning_episodes(
        self, start: SharedStart, method: Method, number: int, checkpoint: Checkpoint
    ) -> list[Episode]:
        checkpoints = start.checkpoints
        digest = checkpoints.digest(checkpoint)
        driver = GatedPolicy(checkpoints.path(checkpoint), digest)
        count = self.plan.schedule.episodes
        driven = self._supervised(driver)
        return self._episodes(Purpose.LEARNING, method.name, number, count, driven, digest)

    def _episodes(
        self,
        purpose: Purpose,
        method: str,
        number: int,
        count: int,
        driver: Driver,
        checkpoint: str = "",
    ) -> list[Episode]:
        """Run or read `count` episodes of round `number`; all of them are on the disk then."""
        variant = self.plan.schedule.variant
        infos = [
            EpisodeInfo.of(
                self.spec,
                variant=variant,
                # Not by method: all methods meet the same scenes in the same round.
                seed=scene_seed(purpose, self.run_seed, number, index),
                purpose=purpose,
                method=method,
                round=number,
                index=index,
                run_seed=self.run_seed,
                checkpoint=checkpoint,
            )
            for index in range(count)
        ]
        requests = [EpisodeRequest(self.task, info, driver) for info in infos]
        return list(self.executor.map(requests, self.store, self.listeners, self.report))

    def _share(self, method: Method, number: int) -> float | None:
        """The expert's share in a round, where a schedule or another method says so."""
        if method.share is not None:
            return method.share(self.plan.schedule, number)
        if method.share_from is None:
            return None
        path = self._path(method.share_from, number, "json")
        if not path.exists():
            raise ParameterError(
                f"{method.name} is given the expert share of {method.share_from}, which has no "
                f"round {number} for seed {self.run_seed} yet; run {method.share_from} first"
            )
        return expert_share(read_result(path).executed)

    def _shown(
        self,
        start: SharedStart,
        driver: Checkpoint,
        fitted: Checkpoint,
        episodes: Sequence[Episode],
        states: int,
    ) -> RoundResult:
        """What the round showed: `driver` drove it, `fitted` was fitted after it to `states`."""
        begin = time.perf_counter()
        tolerance = self.spec.action.tolerance
        metrics = compute_round_metrics(episodes, driver, fitted, start.check, tolerance)
        evaluation = Evaluation(self.task, self.plan, self.spec, self.executor, self.report)
        digest = start.checkpoints.digest(fitted)
        alone = PolicyAlone(start.checkpoints.path(fitted), digest)
        policy = evaluation.of(alone, fitted)
        last = self._is_last(fitted.method, fitted.round, metrics.surrogate_loss)
        final = evaluation.of(alone, fitted, final=True) if last else ()
        return RoundResult(
            method=fitted.method,
            run_seed=self.run_seed,
            round=fitted.round,
            checkpoint=digest,
            executed=tuple(record_of(episode) for episode in episodes),
            policy=policy,
            final=final,
            false_alarm_rate=metrics.false_alarm_rate,
            missed_rate=metrics.missed_rate,
            surrogate_loss=metrics.surrogate_loss,
            bound=metrics.bound,
            threshold=fitted.threshold,
            states=states,
            wall_s=time.perf_counter() - begin,
        )

    def _is_last(self, method: str, number: int, surrogate_loss: float) -> bool:
        # In round 0 the expert drove; its states say nothing about the policy.
        good_enough = number > 0 and surrogate_loss < self.plan.schedule.stop_below_loss
        return number == self._rounds_of(method) or good_enough

    def _rounds_of(self, method: str) -> int:
        """The plan's rounds, or fewer where the method that this one follows stopped before."""
        follows = METHODS[method].share_from if method in METHODS else None
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
