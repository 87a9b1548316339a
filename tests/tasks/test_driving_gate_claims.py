"""The claims of driving's gates find their numbers in a summary of the benchmark's shape."""

import json
from pathlib import Path

from sheath_manip.experiments.claims import verdicts
from sheath_manip.experiments.gates.plan import PLANS
from sheath_manip.policies import DEFAULT_EMBEDDING
from sheath_manip.tasks.driving.study.entry import STUDY
from sheath_manip.tasks.driving.study.probes import PROBES


def row(costly: float, *signals: str) -> dict:
    names = [displacement.name for displacement in PROBES.displacements]
    return {
        "signals": signals,
        "auroc": dict.fromkeys(names, 0.995),
        "few": {"expert_inside": 0.93, "far_outside": dict.fromkeys(names, 0.97)},
        "errs": {"costly": costly},
        "alarm": {"foreseen": 0.95},
    }


def broken(directory: Path, default: dict, *others: dict) -> list[str]:
    summary = {
        "plan": PLANS["full"].described(),
        "tasks": {
            "driving": {
                "default": "joined",
                "learning": STUDY.plans["full"].described(),
                "rows": {
                    "joined": default,
                    f"{DEFAULT_EMBEDDING}/one-class-svm": {
                        **default,
                        "signals": ["support"],
                        "errs": {"costly": 0.6},
                    },
                    **{f"c/{number}": other for number, other in enumerate(others)},
                    "policy": {"signals": [], "loop": {}},
                },
            }
        },
    }
    (directory / "gates").mkdir(exist_ok=True)
    (directory / "gates" / "summary.json").write_text(json.dumps(summary))
    found = verdicts(directory, {"gates": PROBES.claims})
    assert len(found) == len(PROBES.claims)
    return [verdict.name for verdict in found if not verdict.holds]


def test_they_hold_where_the_numbers_are_good(tmp_path):
    assert broken(tmp_path, row(0.8, "s", "t"), row(0.7, "s")) == []


def test_the_default_is_held_against_single_signals_only(tmp_path):
    assert broken(tmp_path, row(0.8, "s", "t"), row(0.9, "s", "t"), row(0.7, "s")) == []
    beaten = broken(tmp_path, row(0.8, "s", "t"), row(0.9, "s"))
    assert beaten == ["AUROC of costly mistakes, best single signal's"]


def test_one_displacement_seen_badly_breaks_them(tmp_path):
    default = row(0.7, "s", "t")
    default["auroc"]["heading 45°"] = 0.9
    default["few"]["far_outside"]["lateral 7 m"] = 0.9
    assert len(broken(tmp_path, default, row(0.6, "s"))) == 3
