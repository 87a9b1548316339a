"""One policy that gates watch over: where it lies, its scenes, and what is fitted around it."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.takeovers.plan import METHOD, TakeoversPlan
from sheath_manip.experiments.takeovers.stretch import StretchEnvironment
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.results import EXPERT, round_path
from sheath_manip.signals import PRECEDENTS
from sheath_manip.task import Task
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples, samples_from


@dataclass(frozen=True, eq=False)
class Watched:
    """The policy of one training seed after some rounds."""

    study: Study
    plan: TakeoversPlan
    """as it is for the study's task"""
    runs: Path
    """of this task"""
    seed: int
    rounds: int

    @property
    def task(self) -> Task:
        """The study's."""
        return self.study.task

    @property
    def name(self) -> str:
        """Of the policy, in files."""
        return f"s{self.seed}-r{self.rounds}"

    @property
    def learning(self) -> LearningPlan:
        """By which it learned."""
        return self.plan.of(self.study)

    @property
    def store(self) -> EpisodeStore:
        """The episodes of all seeds."""
        return EpisodeStore(self.runs / "store")

    @property
    def directory(self) -> Path:
        """Of all that is measured of it."""
        return self.runs / self.name

    @property
    def checkpoint_path(self) -> Path:
        """Of the policy, whose own gate is not looked at."""
        method = METHOD if self.rounds else EXPERT
        return round_path(self.runs, self.seed, method, self.rounds, "npz")

    def fitted_path(self, signal: str) -> Path:
        """Of the policy with a gate that judges by `signal`."""
        return self.directory / f"{signal}.npz"

    def held_out_path(self, signal: str) -> Path:
        """Of that signal's scores of the expert's held-out episodes."""
        return self.directory / f"{signal}-held-out.npy"

    def scores_path(self, lot: str, signal: str) -> Path:
        """Of that signal's scores of the policy's steps alone, on the scenes of a lot."""
        return self.directory / lot / f"{signal}.npz"

    def alone_path(self, lot: str) -> Path:
        """Of what the policy did alone."""
        return self.directory / lot / "alone.json"

    def trials_path(self, lot: str, way: str) -> Path:
        """Of what happened under a way of taking over."""
        return self.directory / lot / f"{way}.json"

    def environment(self) -> StretchEnvironment:
        """A new one, of the variant that is learned on."""
        variant = self.learning.schedule.variant
        return StretchEnvironment(self.task.make_for_run(variant, self.seed))

    def stretch_steps(self, spec: TaskSpec) -> int | None:
        """Return how many steps a scene has; None where it is the whole episode."""
        length_s = self.plan.stretch_s
        return None if length_s is None else max(1, round(length_s * spec.control_rate_hz))

    def spec(self) -> TaskSpec:
        """The task's."""
        environment = self.environment()
        environment.close()
        return environment.spec

    def checkpoint(self, spec: TaskSpec) -> Checkpoint:
        """Read the policy."""
        return load_checkpoint(self.checkpoint_path, spec)

    def states(self, checkpoint: Checkpoint) -> Samples:
        """Return what the policy was fitted to."""
        return samples_from(self.store.read_many(checkpoint.fitted.sources.fitted_to))

    def calibration(self, checkpoint: Checkpoint) -> list[Samples]:
        """Return the expert's held-out episodes."""
        names: Iterable[str] = checkpoint.fitted.sources.held_out
        return [samples_from([episode]) for episode in self.store.read_many(names)]

    def config(self, signal: str) -> GateConfig:
        """Return the settings of a gate that judges by one of the plan's signals."""
        gate = self.learning.gate
        named = {
            "default": gate.signal,
            "precedent": PRECEDENTS.get(gate.signal, gate.signal),
        }.get(signal, signal)
        # These are the kind's to say.
        without = ("release_rate", "quiet_steps", "minimum_hold_steps")
        return self.learning.changed(gate={"signal": named, **dict.fromkeys(without, 0)}).gate
