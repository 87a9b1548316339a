"""The benchmark's jobs: learn, drive alone, fit, try, choose, try again. Each is resumable."""

from collections.abc import Sequence
from dataclasses import dataclass

from sheath_manip.experiments.learning import Job as Learn
from sheath_manip.experiments.takeovers.alone import Alone, alone_on, try_alone
from sheath_manip.experiments.takeovers.choosing import (
    choose,
    level_name,
    read_choices,
    target_name,
    write_choices,
)
from sheath_manip.experiments.takeovers.oracle import try_oracle
from sheath_manip.experiments.takeovers.plan import (
    BASELINES_OF,
    FRESH,
    METHOD,
    TUNING,
    GateChoice,
    Kind,
)
from sheath_manip.experiments.takeovers.schedules import SCHEDULES, Gated
from sheath_manip.experiments.takeovers.scoring import fit_and_score, scene_key
from sheath_manip.experiments.takeovers.trial import Trial, read_trials, write_trials
from sheath_manip.experiments.takeovers.trying import try_gates, try_schedules
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.executor import Executor
from sheath_manip.seeding import generator

CHOICES = "choices.json"
GATES, BASELINES, ORACLE = "gates", "baselines", "oracle"
"""files of trials on fresh scenes"""


@dataclass(frozen=True)
class DriveAlone:
    """Let the policy drive alone, until enough scenes have failed."""

    at: Watched
    lot: str

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        if not self.at.alone_path(self.lot).exists():
            try_alone(self.at, self.lot, lambda _: None)
        report(f"{self.at.study.name} {self.at.name} alone")


@dataclass(frozen=True)
class FitGates:
    """Fit a gate for each signal, and score what the policy did alone."""

    at: Watched

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        if not all(self.at.fitted_path(name).exists() for name in self.at.plan.signals):
            fit_and_score(self.at, lambda _: None)
        report(f"{self.at.study.name} {self.at.name} gates")


@dataclass(frozen=True)
class Tune:
    """Try one kind of gate on tuning scenes, at every level."""

    at: Watched
    kind: Kind

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        levels = self.at.plan.levels_of(self.kind)
        path = self.at.trials_path(TUNING, self.kind.name)
        if not path.exists():
            tried = try_gates(
                self.at, TUNING, [GateChoice.of(self.kind, level) for level in levels]
            )
            write_trials(path, dict(zip(map(level_name, levels), tried, strict=True)))
        report(f"{self.at.study.name} {self.at.name} tuning")


@dataclass(frozen=True)
class Choose:
    """Choose gates and thresholds of one task by its tuning scenes."""

    policies: tuple[Watched, ...]

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done: what was chosen stays chosen."""
        del executor, listeners
        path = self.policies[0].runs / CHOICES
        if not path.exists():
            write_choices(path, choose(self.policies))
        report(f"{self.policies[0].study.name} chosen")


@dataclass(frozen=True)
class TryChosen:
    """Try the chosen gates on fresh scenes."""

    at: Watched

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        path = self.at.trials_path(FRESH, GATES)
        if not path.exists():
            chosen = read_choices(self.at.runs / CHOICES)
            trials: dict[str, list[Trial]] = {}
            for signal in dict.fromkeys(choice.signal for choice in chosen.values()):
                of = {name: each for name, each in chosen.items() if each.signal == signal}
                tried = try_gates(self.at, FRESH, list(of.values()))
                trials |= dict(zip(of, tried, strict=True))
            write_trials(path, trials)
        report(f"{self.at.study.name} {self.at.name} gates, fresh")


@dataclass(frozen=True)
class TryBaselines:
    """Try what looks at nothing, as often and as long as the chosen gates, on fresh scenes."""

    at: Watched

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        at, path = self.at, self.at.trials_path(FRESH, BASELINES)
        if not path.exists():
            gates, scenes = (
                read_trials(at.trials_path(FRESH, GATES)),
                Alone.read(at, FRESH).scenes,
            )
            spec = at.spec()
            alone_steps = [len(alone_on(at, spec, FRESH, scene)) for scene in scenes]
            schedules = {
                f"{target_name(axis, value)}/{name}": {
                    scene: SCHEDULES[name](
                        Gated(gates[target_name(axis, value)], alone_steps),
                        place,
                        generator("takeovers", at.name, axis, str(value), name, scene_key(scene)),
                    )
                    for place, scene in enumerate(scenes)
                }
                for axis, value in at.plan.targets()
                for name in BASELINES_OF[axis]
            }
            write_trials(path, dict(try_schedules(at, FRESH, schedules)))
        report(f"{at.study.name} {at.name} baselines")


@dataclass(frozen=True)
class TryOracle:
    """Try what no gate can know, on some fresh scenes."""

    at: Watched

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        path = self.at.trials_path(FRESH, ORACLE)
        if not path.exists():
            write_trials(path, {ORACLE: try_oracle(self.at, FRESH, self.at.plan.oracle)})
        report(f"{self.at.study.name} {self.at.name} oracle")


AnyJob = Learn | DriveAlone | FitGates | Tune | Choose | TryChosen | TryBaselines | TryOracle


def stages(policies: Sequence[Watched]) -> list[list[AnyJob]]:
    """Return what must be done before what, for all tasks side by side."""
    learners = {(at.study.name, at.seed): at for at in policies}
    learn: list[AnyJob] = [
        Learn(at.task, at.learning, at.runs, at.seed, METHOD) for at in learners.values()
    ]
    tasks = dict.fromkeys(at.study.name for at in policies)
    of_task = [tuple(at for at in policies if at.study.name == name) for name in tasks]
    return [
        learn,
        [DriveAlone(at, lot) for at in policies for lot in (FRESH, TUNING)],
        [FitGates(at) for at in policies],
        [Tune(at, kind) for at in policies for kind in at.plan.kinds],
        [Choose(each) for each in of_task],
        [TryChosen(at) for at in policies],
        [*map(TryBaselines, policies), *map(TryOracle, policies)],
    ]
