"""Where episodes are run: one environment, kept as long as the next episode wants the same."""

import logging
from collections.abc import Sequence

from sheath_manip.protocols import Environment, Listener, Report
from sheath_manip.protocols.closing import Closes
from sheath_manip.rollout.guard import BrokenError, ask, built
from sheath_manip.rollout.request import Crew, Driver, EpisodeRequest, run_request
from sheath_manip.rollout.stage import ENVIRONMENT
from sheath_manip.task import Task
from sheath_manip.types import Episode

logger = logging.getLogger(__name__)


Place = tuple[Task, str, int]
"""of an environment: its task, its variant, and the seed of the training run where that matters"""


class Workplace(Closes):
    """Makes environment and crew of a request, or has them still; to be closed.

    Making an environment costs .1 to .75 s, and reading a checkpoint as much.
    """

    def __init__(self) -> None:
        self._place: Place | None = None
        self._environment: Environment | None = None
        self._driver: Driver | None = None
        self._crew: Crew | None = None

    def run(
        self,
        request: EpisodeRequest,
        listeners: Sequence[Listener] = (),
        report: Report = lambda _: None,
    ) -> Episode:
        """Run the episode."""
        environment = self.environment(request.task, request.info.variant, request.info.run_seed)
        if self._crew is None or self._driver != request.driver:
            self._crew = built("crew", request.driver.crew, request.task, environment)
            self._driver = request.driver
        return run_request(request, environment, self._crew, listeners, report)

    def environment(self, task: Task, variant: str, run_seed: int) -> Environment:
        """Return the environment that stands here, another one only where another is wanted."""
        # Only a variant of the run's own is another one in another run.
        place = task, variant, run_seed if variant in task.run_variants else 0
        if self._environment is None or not _same(self._place, place):
            self.close()
            self._environment = built(ENVIRONMENT, task.make_for_run, variant, run_seed)
            self._place = place
        return self._environment

    def close(self) -> None:
        """Free the simulator."""
        environment, self._environment = self._environment, None
        self._crew = self._driver = None
        if environment is None:
            return
        try:
            ask(ENVIRONMENT, environment.close)
        except BrokenError as error:
            # What was run is on the disk, and the program may go on.
            logger.warning("%s while it was closed", error)


def _same(one: Place | None, other: Place) -> bool:
    # Each request that comes from another process brings a task of its own.
    return one is not None and one[1:] == other[1:] and other[0].same_as(one[0])
