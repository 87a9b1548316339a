"""Checkpoints of schema 2, which knew their signal but not how their gate holds and labels."""

import json
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import CheckpointError, SheathError
from sheath_manip.files.plain_files import read_plain
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.flat_plans import upgraded
from sheath_manip.learning.methods import METHODS

PLAN = "plan.json"
LEVELS = 3
"""a run's plan lies at most so many folders above its checkpoints"""
MOST_PLAN_BYTES = 1 << 20


def header_of_schema_2(path: Path, header: dict[str, Any]) -> dict[str, Any]:
    """Return a header of schema 3 for the one of a file at `path`.

    What a gate of schema 2 was set to stands in the plan of the run beside it. Raises
    CheckpointError where there is none.
    """
    above = [folder / PLAN for folder in list(path.resolve().parents)[:LEVELS]]
    found = next((plan for plan in above if plan.is_file()), None)
    if found is None:
        raise CheckpointError(
            f"{path} is of schema 2, which does not say how its gate holds and labels, and no "
            f"{PLAN} of its run lies beside it; wanted it where the run wrote it: or train again"
        )
    try:
        written = upgraded(json.loads(read_plain(found, MOST_PLAN_BYTES)))
        plan = LearningPlan(gate=GateConfig.from_described(written["gate"]))
        if header["method"] in METHODS:
            plan = METHODS[header["method"]].plan(plan)
        signal = header["signal"]
        support = {"name": signal["support"], **signal["hyperparameters"]}
        config = plan.changed(
            gate={
                "signal": signal["signal"],
                "embedding": signal["embedding"],
                "precedent_embedding": signal["precedent_embedding"],
                "support": support,
                "threshold": {"false_alarm_rate": header["false_alarm_rate"]},
            }
        ).gate
        return {
            **header,
            "schema": 3,
            "gate": config.described(),
            "has_signal": True,
            # Files from before there was one have none.
            "release_margin": header.get("release_margin", 0.0),
            "sources": {"fitted_to": [], "held_out": []},
            "training_loss": float("nan"),
        }
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        RecursionError,
        SheathError,
    ) as error:
        raise CheckpointError(f"{path} of schema 2 does not fit {found}: {error}") from error
