"""`sheath train`: a policy and its gate from the episodes of a store."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from rich.table import Table
from rich.text import Text

from sheath_manip.cli.computing import Computing
from sheath_manip.cli.options import WITHOUT_PREFIX, TaskName, default_is
from sheath_manip.cli.planned import Planned, asked_policy
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import LearningPlan, Schedule
from sheath_manip.metrics import endings_line
from sheath_manip.policies.config import PolicyConfig

if TYPE_CHECKING:
    from sheath_manip.dataset.reader import EpisodeSummary
    from sheath_manip.protocols import TrainablePolicy
    from sheath_manip.types import TaskSpec


@dataclass(frozen=True, kw_only=True)
class Train(Planned):
    """Fit a policy, the support of its training states, and the threshold of its gate.

    All labelled states of the store are trained on, but for expert episodes that failed, and for
    some that are held out for the threshold.
    """

    task: TaskName
    """name of the task, as `sheath tasks` lists it, or its place, `file.py:TASK`"""
    store: str
    """directory of the episodes, as `sheath collect` records them, or a URL"""
    checkpoint: Path
    """file to write, such as runs/first.npz"""
    policy: PolicyConfig = field(default_factory=PolicyConfig)
    gate: GateConfig = field(default_factory=GateConfig)
    calibration: int = Schedule.calibration
    """expert episodes held out for the threshold, at least 3"""
    failures: bool = False
    """train also on expert episodes that did not succeed, by what was recorded or marked"""
    seed: int = 0
    """seed of the policy's first weights and the order of its batches"""
    computing: Annotated[Computing, WITHOUT_PREFIX] = field(default_factory=Computing)
    cache: Annotated[Path | None, default_is("beside the checkpoint, until the end")] = None
    """directory to keep the training states in, for the next call on the same episodes: they are
    read from mapped files, which take the room that the images take in memory"""

    @property
    def size(self) -> str:
        """Name of the plan."""
        return "full"

    @classmethod
    def settings(cls, plan: LearningPlan) -> dict[str, Any]:
        """Return what `plan` says of policy, gate and held-out episodes."""
        calibration = plan.schedule.calibration
        return {"policy": plan.policy, "gate": plan.gate, "calibration": calibration}

    def run(self, session: Session) -> int:
        """Fit, save, and print what came of it."""
        self.computing.begin()
        task = session.task(self.task)
        config = asked_policy(self.policy, session.study(self.task).plan(self.size))
        Schedule(calibration=self.calibration)
        # Only now: torch takes seconds to import.
        from sheath_manip.cli.episodes import opened
        from sheath_manip.dataset.compatibility import remarks
        from sheath_manip.dataset.finite import require_finite_features
        from sheath_manip.dataset.locations import open_store
        from sheath_manip.dataset.mapped import mapped_once, mapped_samples
        from sheath_manip.gates.fitted import Sources
        from sheath_manip.learning.beforehand import require_makeable
        from sheath_manip.learning.checkpoint import Checkpoint, digest
        from sheath_manip.learning.demonstrations import left_out_line
        from sheath_manip.learning.fitting import fit_gate
        from sheath_manip.learning.keeping import keep
        from sheath_manip.learning.splitting import learned_and_left, split_off
        from sheath_manip.learning.suited import suited
        from sheath_manip.policies import make_policy
        from sheath_manip.policies.agreement import held_out_agreement
        from sheath_manip.types.samples import samples_from

        store = open_store(self.store)
        summaries = store.infos()
        with opened(task, _variant(summaries, task.name)) as environment:
            spec = environment.spec
        self._require_fits(summaries, spec)
        plan, line = suited(spec, LearningPlan(config, self.gate))
        config, wanted = plan.policy, plan.gate
        session.remark(line)

        def fresh_policy() -> "TrainablePolicy":
            return make_policy(config.name, spec, seed=self.seed, **config.settings)

        # Before the fit, which takes its time, so that a wrong name is told at once.
        require_makeable(spec, config, wanted)
        if self.checkpoint.is_dir():
            raise ParameterError(f"{self.checkpoint} is a directory; wanted a file to write")

        taken, left_out = learned_and_left(summaries, self.failures)
        training, held_out = split_off(
            taken,
            left_out,
            self.calibration,
            self.store,
            f"record more with `sheath collect {self.task}`",
        )
        with session.err.status("reading"):
            require_finite_features(store, [*training, *held_out])
            states = (
                mapped_once(store, training, self.checkpoint)
                if self.cache is None
                else mapped_samples(store, training, self.cache)
            )
            calibration = [samples_from(store.learnable([name])) for name in held_out]
        with session.err.status(f"fitting {config.name} to {len(states)} states"):
            policy = fresh_policy().fit(states)
        with session.err.status(f"fitting {wanted.support.name} on {wanted.embedding}"):
            fit = fit_gate(
                policy,
                states,
                calibration,
                wanted,
                sources=Sources(tuple(training), tuple(held_out)),
                agreement=lambda: held_out_agreement(
                    fresh_policy, states, tolerance=spec.action.tolerance
                ),
            )
        fitted = Checkpoint(
            spec.name,
            config.name,
            policy,
            fit.gate,
            run_seed=self.seed,
            training_loss=fit.training_loss,
        )
        keep(fitted, self.checkpoint)

        gate, looks = fit.gate, fit.looks
        alarms = [
            float(np.mean(~(gate.scores_of(seen) >= gate.threshold))) for seen in looks.calibration
        ]
        inside = float((gate.scores_of(looks.states) >= gate.threshold).mean())
        table = Table(title=Text(str(self.checkpoint)), title_justify="left", show_header=False)
        table.box = None
        rows = {
            "trained on": f"{len(states)} states of {len(training)} episodes, "
            f"{_outcomes(summaries, training)}",
            "training loss": f"{fit.training_loss:.4f}",
            "training states above the threshold": f"{inside:.1%}",
            "threshold": f"{gate.threshold:.4g}",
            "steps below it": f"{np.mean(alarms):.1%} in the {len(held_out)} held-out expert "
            f"episodes it was set on; {wanted.threshold.false_alarm_rate:.1%} asked for",
            "digest": digest(self.checkpoint),
        }
        for name, value in rows.items():
            table.add_row(name, Text(value))
        session.out.print(table)
        if left_out:
            session.out.print(Text(left_out_line(each.outcome for each in left_out)))
        for remark in remarks((each.info.variant, each.spec) for each in taken):
            session.out.print(Text(remark))
        return 0

    def _require_fits(self, summaries: "Sequence[EpisodeSummary]", spec: "TaskSpec") -> None:
        from sheath_manip.dataset.compatibility import RecordedSpec, require_compatible

        wanted = RecordedSpec.of_task(spec)
        for each in summaries:
            remedy = (
                "train on a store of episodes that are alike, such as "
                f"`sheath collect {spec.name}` records"
            )
            who = f"{each.name} of {self.store}"
            require_compatible(wanted, each.spec, who, f"the task {spec.name}", remedy)


def _variant(summaries: "Sequence[EpisodeSummary]", task: str) -> str:
    """The first that is recorded of the task: all must fit the environment that it makes."""
    told = (s.info.variant for s in summaries if s.info.variant and s.info.task == task)
    return next(told, "default")


def _outcomes(summaries: "Sequence[EpisodeSummary]", names: Sequence[str]) -> str:
    """How the named episodes ended."""
    taken = set(names)
    return endings_line(each.outcome for each in summaries if each.name in taken)
