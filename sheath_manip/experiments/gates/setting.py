"""One task and one training seed of the benchmark: what is measured there and where it lies."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.gates.plan import GatesPlan
from sheath_manip.experiments.probes import Probes
from sheath_manip.experiments.study import Study
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.results import EXPERT, round_path
from sheath_manip.protocols import Environment
from sheath_manip.seeding import scene_seed
from sheath_manip.task import Task
from sheath_manip.types import Episode, Purpose, TaskSpec
from sheath_manip.types.samples import Samples, samples_from


@dataclass(frozen=True)
class Setting:
    """A setting that travels to worker processes; what it names is read from the disk there."""

    study: Study
    plan: GatesPlan
    runs: Path
    """of this task"""
    seed: int
    """of the training run"""

    @property
    def task(self) -> Task:
        """The study's."""
        return self.study.task

    @property
    def learning(self) -> LearningPlan:
        """What is demonstrated and fitted; raises UnknownNameError where the task has no such."""
        plan = self.study.plan(self.plan.learning)
        return plan.changed(comparison={"seeds": self.plan.seeds})

    @property
    def probes(self) -> Probes:
        """What the task puts before a gate."""
        if self.study.probes is None:
            raise ParameterError(f"task {self.study.name} has no probes; wanted one that has")
        return self.study.probes

    @property
    def directory(self) -> Path:
        """The directory for all that is no episode."""
        return self.runs / f"s{self.seed}"

    @property
    def in_loop(self) -> bool:
        """Whether this seed's gates take part in the loop."""
        return self.seed in self.plan.seeds[: self.plan.loop_seeds]

    def environment(self) -> Environment:
        """A new one, of the variant that is learned on."""
        return self.task.make_for_run(self.learning.schedule.variant, self.seed)

    def store(self) -> EpisodeStore:
        """The episodes of all seeds."""
        return EpisodeStore(self.runs / "store")

    def cloned_path(self) -> Path:
        """Return the path of the policy that all gates watch over, fitted to demonstrations."""
        return round_path(self.runs, self.seed, EXPERT, 0, "npz")

    def cloned(self, spec: TaskSpec) -> Checkpoint:
        """Return the policy that all gates watch over, with the default gate."""
        return load_checkpoint(self.cloned_path(), spec)

    def offline_path(self, row: str) -> Path:
        """Return the path of what a row's scores say about recorded states."""
        return self.directory / "offline" / f"{row}.json"

    def agreement_path(self) -> Path:
        """Return the path of where policies do as the label says of a state new to them."""
        return self.directory / "agreement.npy"

    def checkpoint_path(self, row: str) -> Path:
        """Return the path of a row's gate."""
        return self.directory / "offline" / f"{row}.npz"

    def loop_path(self, row: str) -> Path:
        """Return the path of what happened under a row's gate."""
        return self.directory / "loop" / f"{row}.json"

    def demonstrations(self) -> Samples:
        """Return what the policy and every gate are fitted to."""
        return samples_from(
            self.store().episodes(Purpose.DEMONSTRATION, EXPERT, 0, run_seed=self.seed)
        )

    def calibration(self) -> list[Samples]:
        """Return the held-out expert episodes, for thresholds."""
        return [samples_from([episode]) for episode in self._held_out()][
            : self.learning.schedule.calibration
        ]

    def fresh(self) -> list[Episode]:
        """New expert episodes, which neither fits nor thresholds have seen."""
        return list(self._held_out())[self.learning.schedule.calibration :]

    def evaluation_seeds(self, count: int) -> list[int]:
        """Held-out scenes, on which no one learns."""
        name = self.learning.comparison.held_out_set
        return [scene_seed(Purpose.EVALUATION, name, index) for index in range(count)]

    def _held_out(self) -> Iterable[Episode]:
        return self.store().episodes(Purpose.CALIBRATION, EXPERT, 0, run_seed=self.seed)
