"""`sheath gate`: a gate for a policy that stays as it is, from recorded episodes alone."""

import inspect
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import tyro
from rich.table import Table
from rich.text import Text

from sheath_manip.cli.computing import Computing
from sheath_manip.cli.examples import described
from sheath_manip.cli.options import WITHOUT_PREFIX, default_is
from sheath_manip.cli.session import Session, Verb
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import LEAST_CALIBRATION, Schedule
from sheath_manip.learning.frozen_settings import FROZEN
from sheath_manip.printable import printable

if TYPE_CHECKING:
    from sheath_manip.dataset.reader import EpisodeReader
    from sheath_manip.learning.external import External
    from sheath_manip.learning.fitting import Fit
    from sheath_manip.learning.gate_file import ExternalGate

MOST_LISTED = 3
"""names of episodes in one line"""
GateFile = Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="GATE")]


@dataclass(frozen=True, kw_only=True)
class FitGate:
    """Fit a gate to a policy that stays as it is, from recorded episodes; no environment is made.

    The policy looks along each episode as if it drove. The threshold is set on some of the
    episodes, which nothing else is fitted to. The file is for `sheath_manip.load_gate` in a control
    loop of your own. For `suited` stands what suits policy and data: the policy's own latent where
    it gives one, else pixels and features.
    """

    policy: str
    """policy: file.py:NAME or module:NAME, where NAME is a function of one observation, a torch
    module or a policy; or lerobot:DIR, as LeRobot wrote it. Its code is run: give none that you
    would not run yourself"""
    data: str
    """expert episodes: a store, directory or URL, or another tool's data as FORMAT:PATH, such as
    lerobot:DIR, minari:ID or robomimic:demo.hdf5"""
    out: Path
    """file to write, such as gate.npz"""
    gate: GateConfig = field(default_factory=lambda: FROZEN)
    calibration: Annotated[int | None, default_is("a third of them, at most 30")] = None
    """expert episodes held out for the threshold, at least 3"""
    failures: bool = False
    """take expert episodes that did not succeed, too"""
    keys: Annotated[tuple[str, ...], default_is("the format's own")] = ()
    """of another tool's data, what its keys mean: images/CAMERA=KEY, features=KEY,KEY,...,
    action=KEY"""
    computing: Annotated[Computing, WITHOUT_PREFIX] = field(default_factory=Computing)
    task: Annotated[str | None, default_is("as the data says")] = None
    """of another tool's data, name of the task"""
    control_rate_hz: Annotated[float | None, default_is("as the data says")] = None
    """of another tool's data, control steps a second"""

    def run(self, session: Session) -> int:
        """Fit, save, and print what came of it."""
        self.computing.begin()
        if self.out.is_dir():
            raise ParameterError(f"{self.out} is a directory; wanted a file to write")
        # Only now: torch takes seconds to import.
        from sheath_manip.adapters.recorded_episodes import episodes_of, told_origin

        origin = told_origin(self.task or "", self.control_rate_hz, self.keys)
        with session.err.status(f"reading {self.data}"), episodes_of(self.data, origin) as reader:
            return self._fit(reader, session)

    def _fit(self, reader: "EpisodeReader", session: Session) -> int:
        from sheath_manip.cli.own_policies import policy_named
        from sheath_manip.dataset.compatibility import Alike
        from sheath_manip.dataset.finite import require_finite_features
        from sheath_manip.dataset.recorded_task import task_of
        from sheath_manip.gates.fitted import Sources
        from sheath_manip.learning.demonstrations import left_out_line
        from sheath_manip.learning.external import External
        from sheath_manip.learning.frozen import fit_frozen_gate
        from sheath_manip.learning.gate_file import ExternalGate
        from sheath_manip.learning.keeping import keep
        from sheath_manip.learning.splitting import learned_and_left, split_off

        summaries = reader.infos()
        taken, left_out = learned_and_left(summaries, self.failures)
        names, held_out = split_off(
            taken, left_out, self._held_out(len(taken)), self.data, "record more"
        )
        require_finite_features(reader, [*names, *held_out])
        alike = Alike("give data of one task, whose episodes are alike")
        for each in taken:
            alike.take(f"{each.name} of {self.data}", each.spec)
        # One that tells its names tells more than the others.
        recorded = max((each.spec for each in taken), key=lambda spec: spec.space is not None)
        spec = task_of(recorded)
        policy = policy_named(self.policy, None if recorded.space is None else spec.action)
        fit = fit_frozen_gate(
            policy,
            reader.learnable(names),
            reader.learnable(held_out),
            self.gate,
            spec,
            sources=Sources(tuple(names), tuple(held_out)),
        )
        told = External(self.policy, self.data, recorded, reader.header(names[0]).instruction)
        made = ExternalGate(fit.gate, told, fit.training_loss)
        keep(made, self.out)
        session.out.print(_table(self.out, self._rows(fit, made)))
        if left_out:
            session.out.print(Text(left_out_line(each.outcome for each in left_out)))
        return 0

    def _held_out(self, episodes: int) -> int:
        if self.calibration is None:
            return max(LEAST_CALIBRATION, min(episodes // 3, Schedule.calibration))
        return Schedule(calibration=self.calibration).calibration

    def _rows(self, fit: "Fit", made: "ExternalGate") -> dict[str, str]:
        from sheath_manip.learning.checkpoint import digest

        gate, looks = fit.gate, fit.looks
        alarms = np.concatenate(
            [~(gate.scores_of(seen) >= gate.threshold) for seen in looks.calibration]
        )
        inside = float((gate.scores_of(looks.states) >= gate.threshold).mean())
        asked = gate.config.threshold
        rate = f"; {asked.false_alarm_rate:.1%} asked for" if asked.rule == "steps" else ""
        return {
            "fitted to": f"{len(looks.states)} states of {len(gate.sources.fitted_to)} episodes",
            "policy's loss there": f"{fit.training_loss:.4f}",
            **_described(gate.config, made.external),
            "states above the threshold": f"{inside:.1%}",
            "threshold": f"{gate.threshold:.4g}",
            "false alarms": f"{alarms.mean():.1%} of the {len(alarms)} states of "
            f"{len(looks.calibration)} held-out episodes, which it was set on{rate}",
            "digest": digest(self.out),
        }


@dataclass(frozen=True, kw_only=True)
class ShowGate:
    """Show what a gate was fitted to, and what it is asked of."""

    file: GateFile
    """file that `sheath gate fit` wrote"""

    def run(self, session: Session) -> int:
        """Print it; the policy's code is not run."""
        from sheath_manip.dataset.recorded_task import task_of
        from sheath_manip.learning.gate_file import gate_facts

        facts = gate_facts(self.file)
        recorded, sources = facts.external.recorded, facts.sources
        spec = task_of(recorded)
        cameras = (f"{name} {w}x{h} px" for name, (h, w) in recorded.cameras.items())
        known = "by its answers in made-up states" if facts.knows_policy else "not at all"
        rows = {
            **_described(facts.config, facts.external),
            "threshold": f"{facts.threshold:.4g}",
            "task": f"{recorded.task}, {recorded.control_rate_hz:g} Hz",
            "told": facts.external.instruction or "nothing in words",
            "cameras": ", ".join(cameras) or "none",
            "features": ", ".join(spec.feature_names) or "none",
            "actions": ", ".join(spec.action.names),
            "fitted to": f"{len(sources.fitted_to)} episodes: {_listed(sources.fitted_to)}",
            "held out": f"{len(sources.held_out)} episodes: {_listed(sources.held_out)}",
            "the policy is known again": known,
        }
        session.out.print(_table(self.file, rows))
        return 0


def _choice(name: str, verb: type[Verb]) -> Any:
    words = described(f"gate {name}", inspect.getdoc(verb))
    return tyro.conf.subcommand(name, prefix_name=False, description=words)


@dataclass(frozen=True)
class Gate:
    """Fit a gate to a policy that stays as it is, for a control loop of your own."""

    what: Annotated[
        Annotated[FitGate, _choice("fit", FitGate)]
        | Annotated[ShowGate, _choice("show", ShowGate)],
        WITHOUT_PREFIX,
    ]

    def run(self, session: Session) -> int:
        """Do what was asked for."""
        return self.what.run(session)


def _described(config: GateConfig, external: "External") -> dict[str, str]:
    looked_at = f"signal {config.signal}: the support on {config.embedding}"
    if config.precedent_embedding != config.embedding:
        looked_at += f", precedents on {config.precedent_embedding}"
    return {"policy": external.named, "data": external.data, "judges by": looked_at}


def _table(path: Path, rows: dict[str, str]) -> Table:
    table = Table(title=Text(str(path)), title_justify="left", show_header=False, box=None)
    table.add_column(style="dim")
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, Text(printable(value)))
    return table


def _listed(names: tuple[str, ...]) -> str:
    more = f" and {len(names) - MOST_LISTED} more" * (len(names) > MOST_LISTED)
    return ", ".join(names[:MOST_LISTED]) + more
