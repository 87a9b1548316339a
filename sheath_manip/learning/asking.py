"""Asks for the episodes of a training run: what its store has is read, the rest is run."""

from collections.abc import Callable, Iterator, Sequence

from sheath_manip.dataset.sessions import begun, new_session
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.config import Schedule
from sheath_manip.learning.drivers import ExpertAlone, NoisyExpert
from sheath_manip.learning.results import EXPERT
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.executor import Executor
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import Episode, EpisodeInfo, Purpose, TaskSpec

Beside = Callable[[Driver], Driver]
"""puts a person at the controls beside what drives an episode"""


class RunEpisodes:
    """The episodes of one training seed, by what they are for."""

    def __init__(
        self,
        task: Task,
        schedule: Schedule,
        spec: TaskSpec,
        run_seed: int,
        store: EpisodeStore,
        executor: Executor,
        listeners: Sequence[Listener],
        report: Report,
        supervised: Beside | None = None,
        demonstrated: Beside | None = None,
    ) -> None:
        """Store what is asked for, who is asked, and where it is recorded.

        `supervised` puts a person beside what drives each learning episode, and `demonstrated`
        beside the expert of those before: where the expert is a person at the controls.
        """
        self.task = task
        self.schedule = schedule
        self.spec = spec
        self.run_seed = run_seed
        self.store = store
        self.executor = executor
        self.listeners = listeners
        self.report = report
        self._supervised = supervised
        self._demonstrated = demonstrated
        self._session = new_session()

    def demonstrations(self) -> Iterator[Episode]:
        """Ask for those that are trained on before round 1."""
        schedule = self.schedule
        if schedule.demonstration_noise == 0:
            return self._by_expert(Purpose.DEMONSTRATION, schedule.demonstrations)
        driver = NoisyExpert(schedule.demonstration_noise)
        return self._episodes(Purpose.DEMONSTRATION, EXPERT, 0, schedule.demonstrations, driver)

    def held_out(self) -> Iterator[Episode]:
        """Ask for those for the threshold, and then for those for measuring false alarms."""
        count = self.schedule.calibration + self.schedule.false_alarm_episodes
        return self._by_expert(Purpose.CALIBRATION, count)

    def of_round(self, method: str, number: int, driver: Driver, digest: str) -> Iterator[Episode]:
        """Ask for those of a round, whose checkpoint has that digest."""
        count = self.schedule.episodes
        return self._episodes(
            Purpose.LEARNING, method, number, count, driver, self._supervised, digest
        )

    def infos(
        self, purpose: Purpose, method: str, number: int, count: int, checkpoint: str = ""
    ) -> list[EpisodeInfo]:
        """Return which episodes a round has, whether they are there or not."""
        return [
            EpisodeInfo.of(
                self.spec,
                variant=self.schedule.variant,
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

    def _by_expert(self, purpose: Purpose, count: int) -> Iterator[Episode]:
        return self._episodes(purpose, EXPERT, 0, count, ExpertAlone(), self._demonstrated)

    def _episodes(
        self,
        purpose: Purpose,
        method: str,
        number: int,
        count: int,
        driver: Driver,
        beside: Beside | None = None,
        checkpoint: str = "",
    ) -> Iterator[Episode]:
        """Ask for `count` episodes of round `number`; once all were given, all are on the disk."""
        infos = self.infos(purpose, method, number, count, checkpoint)
        if beside is not None:
            # The same scene by hand again is another episode.
            infos, driver = begun(self.store, infos, self._session), beside(driver)
        requests = [EpisodeRequest(self.task, info, driver) for info in infos]
        return self.executor.map(requests, self.store, self.listeners, self.report)
