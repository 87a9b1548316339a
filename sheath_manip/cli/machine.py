"""`sheath tasks` and `sheath doctor`: what there is to choose from, and whether it can run here."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from rich.table import Table
from rich.text import Text

from sheath_manip.cli import doctor
from sheath_manip.cli.session import Session
from sheath_manip.experiments.study import Study
from sheath_manip.registry import working
from sheath_manip.types import ActionSpec


@dataclass(frozen=True)
class Doctor:
    """Look at this machine: rendering, versions, port, disk; each problem with its cure."""

    def run(self, session: Session) -> int:
        """Print the findings; 1 where there is a problem."""
        return doctor.report(session.out)


@dataclass(frozen=True)
class Tables:
    """List the tasks, and the policies, signals, supports, methods and more to choose from."""

    def run(self, session: Session) -> int:
        """Print the tables."""
        for task in session.tasks():
            session.out.print(_described(session.study(task.name)))
        # Only now: torch takes seconds to import.
        from sheath_manip.dataset.exchange.formats import FORMATS
        from sheath_manip.gates.making import GATES
        from sheath_manip.learning.methods import METHODS
        from sheath_manip.policies import EMBEDDINGS, POLICIES
        from sheath_manip.signals import SIGNALS
        from sheath_manip.support import SUPPORTS
        from sheath_manip.support.calibration import THRESHOLD_RULES

        methods = working(METHODS, session.complain)
        session.out.print(
            _rows(
                "to choose from",
                {
                    "policies": ", ".join(POLICIES),
                    "signals": ", ".join(SIGNALS),
                    "embeddings": ", ".join(EMBEDDINGS),
                    "supports": ", ".join(SUPPORTS),
                    "threshold rules": ", ".join(THRESHOLD_RULES),
                    "gates": ", ".join(GATES),
                    "formats": ", ".join(FORMATS),
                    "methods": "\n".join(f"{m.name}: {m.summary}" for m in methods.values()),
                },
            )
        )
        return 0


def _described(study: Study) -> Table:
    task = study.task
    environment = task.make()
    spec = environment.spec
    environment.close()
    cameras = (f"{name} {w}x{h} px" for name, (h, w) in spec.cameras.items())
    return _rows(
        task.name,
        {
            "summary": task.summary,
            "rate": f"{spec.control_rate_hz:g} Hz, at most {spec.max_steps} steps an episode",
            "cameras": ", ".join(cameras) or "none",
            "actions": _actions(spec.action),
            "judged by": spec.metric,
            "variants": ", ".join((*task.variants, *task.run_variants)),
            "plans": ", ".join(study.plans),
        },
    )


def _actions(action: ActionSpec) -> str:
    if action.choices is not None:
        values = (_numbers(choice) for choice in action.choices)
        return f"{', '.join(action.names)}: {' | '.join(values)}"
    ranges = zip(action.names, action.minimum, action.maximum, strict=True)
    return ", ".join(f"{name}: {low:.3g} .. {high:.3g}" for name, low, high in ranges)


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{float(value):.3g}" for value in np.asarray(values))


def _rows(title: str, rows: dict[str, str]) -> Table:
    table = Table(
        title=Text(title, "bold"), title_justify="left", show_header=False, box=None, pad_edge=False
    )
    table.add_column(style="dim")
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, Text(value))
    return table
