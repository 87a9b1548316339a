"""A worker of a crowd that is no process: for tests that take no seconds."""

from sheath_manip.rollout.worker import Answer, Errand, run_errand
from sheath_manip.rollout.workplace import Workplace


class HereWorker:
    """Runs errands in its thread."""

    def __init__(self) -> None:
        self.workplace = Workplace()

    def begin(self) -> None:
        pass

    def run(self, errand: Errand) -> Answer:
        return run_errand(errand, self.workplace)

    def end(self) -> None:
        pass
