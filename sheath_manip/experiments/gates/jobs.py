"""The benchmark's jobs: what is recorded, what is scored, what is driven. Each is resumable."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sheath_manip.experiments.gates.displaced import displaced_states
from sheath_manip.experiments.gates.loop import Size, run_loop, write_loop
from sheath_manip.experiments.gates.offline import evidence, measured
from sheath_manip.experiments.gates.plan import GatesPlan
from sheath_manip.experiments.gates.remembered import Shared
from sheath_manip.experiments.gates.rows import BASELINES, Row, rows
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.experiments.gates.visited import record_visits
from sheath_manip.files.json_files import plain, write_json
from sheath_manip.files.outputs import written_aside
from sheath_manip.gates.config import planned_signal
from sheath_manip.learning.fitting import Looks, fit_to_looks
from sheath_manip.learning.run import LearningRun
from sheath_manip.policies import make_policy
from sheath_manip.policies.agreement import held_out_agreement
from sheath_manip.policies.looking import look_with_displaced
from sheath_manip.policies.readings import each_once
from sheath_manip.protocols import Listener, Report, TrainablePolicy
from sheath_manip.rollout.executor import Executor
from sheath_manip.seeding import seed_for


@dataclass(frozen=True)
class Demonstrate:
    """Record the expert, and fit the policy that all gates watch over."""

    setting: Setting

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do what is not done yet."""
        at = self.setting
        LearningRun(
            at.task,
            at.learning,
            at.seed,
            at.runs,
            at.store(),
            executor,
            listeners,
            report,
            failures=True,
        ).start()

    def units(self) -> int:
        """Return how often this job reports."""
        plan = self.setting.learning.schedule
        return plan.demonstrations + plan.calibration + plan.false_alarm_episodes + 1


@dataclass(frozen=True)
class Displace:
    """Make the displaced states."""

    setting: Setting

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        displaced_states(self.setting, report)

    def units(self) -> int:
        """Return how often this job reports."""
        new = self.setting.learning.schedule.false_alarm_episodes
        return min(self.setting.plan.displaced_episodes, new)


@dataclass(frozen=True)
class Visit:
    """Let the policy drive alone and record its mistakes."""

    setting: Setting

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do what is not done yet."""
        del executor, listeners
        record_visits(self.setting, report)

    def units(self) -> int:
        """Return how often this job reports."""
        return self.setting.plan.visited


@dataclass(frozen=True)
class Judge:
    """Find out where policies that have not seen a demonstrated state do as the expert there."""

    setting: Setting

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        at = self.setting
        path = at.agreement_path()
        if not path.exists():
            environment = at.environment()
            spec = environment.spec
            environment.close()

            def fresh_policy() -> TrainablePolicy:
                config, seed = at.learning.policy, seed_for("policy", at.seed)
                return make_policy(config.name, spec, seed, **config.settings)

            agrees = held_out_agreement(
                fresh_policy, at.demonstrations(), tolerance=spec.action.tolerance
            )
            with written_aside(path) as aside, aside.open("wb") as file:
                np.save(file, agrees)
        report("cross-fitted policies")

    def units(self) -> int:
        """Return how often this job reports."""
        return 1


@dataclass(frozen=True)
class Score:
    """Fit the gates of one embedding and hold them against the recorded states."""

    setting: Setting
    rows: tuple[Row, ...]

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do what is not done yet."""
        del executor, listeners
        at = self.setting
        missing = [row for row in self.rows if not at.offline_path(row.name).exists()]
        for _ in range(len(self.rows) - len(missing)):
            report("gate")
        if not missing:
            return
        environment = at.environment()
        spec = environment.spec
        environment.close()
        cloned, states, shared = at.cloned(spec), at.demonstrations(), Shared()
        signals = [shared.signal(planned_signal(row.plan.gate)) for row in missing]
        readers = each_once(reader for each in signals for reader in each.attach(cloned.policy))
        displacing = any(each.uses_displaced for each in signals)
        seen = evidence(at, cloned.policy, readers)
        looks = Looks(
            states.labels,
            look_with_displaced(cloned.policy, states, readers, displacing),
            seen.calibration,
        )
        for row, signal in zip(missing, signals, strict=True):
            fitted = fit_to_looks(
                cloned.policy,
                signal,
                looks,
                row.plan.gate,
                sources=cloned.fitted.sources,
                agreement=lambda: np.load(at.agreement_path()),
            )
            dataclasses.replace(cloned, fitted=fitted).save(at.checkpoint_path(row.name))
            offline = measured(fitted, seen, at)
            write_json(at.offline_path(row.name), plain(dataclasses.asdict(offline)))
            report(f"gate {row.name}")

    def units(self) -> int:
        """Return how often this job reports."""
        return len(self.rows)


@dataclass(frozen=True)
class Drive:
    """Put one gate into the loop."""

    setting: Setting
    row: str
    size: Size

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do it, unless it is done."""
        del executor, listeners
        path = self.setting.loop_path(self.row)
        if not path.exists():
            write_loop(path, run_loop(self.setting, self.row, self.size, report))

    def units(self) -> int:
        """Return how often this job reports."""
        rates = self.setting.plan.rates
        gates = BASELINES[self.row](rates) if self.row in BASELINES else rates
        return len(gates) * self.size.episodes + self.size.held_out


AnyJob = Demonstrate | Displace | Visit | Judge | Score | Drive


def stages(settings: Sequence[Setting]) -> list[list[AnyJob]]:
    """Return what must be done before what, the most interesting first."""
    score: list[AnyJob] = []
    first: list[AnyJob] = []
    others: list[AnyJob] = []
    for at in settings:
        listed = rows(at.plan, at.learning)
        embeddings = dict.fromkeys(row.plan.gate.embedding for row in listed)
        for name in embeddings:
            score.append(Score(at, tuple(row for row in listed if row.plan.gate.embedding == name)))
        if not at.in_loop:
            continue
        main, other = main_size(at.plan), other_size(at.plan)
        first += [Drive(at, name, main) for name in BASELINES]
        first += [Drive(at, row.name, main) for row in listed if row.main]
        rest = [row for row in listed if not row.main and at.plan.in_loop(row.main)]
        others += [Drive(at, row.name, other) for row in rest]
    recorded: list[AnyJob] = [
        job for at in settings for job in (Visit(at), Judge(at), Displace(at))
    ]
    return [[Demonstrate(at) for at in settings], recorded, score, [*first, *others]]


def main_size(plan: GatesPlan) -> Size:
    """Return the size for baselines and for rows with one part at most that is no default."""
    return Size(plan.episodes, plan.held_out)


def other_size(plan: GatesPlan) -> Size:
    """Return the size for the rest of the grid."""
    return Size(plan.other_episodes, plan.other_held_out)
