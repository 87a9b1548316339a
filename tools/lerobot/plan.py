"""How much of everything a run has, and that a folder belongs to one plan."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sheath_manip.exceptions import ParameterError
from sheath_manip.files.json_files import plain, write_json


@dataclass(frozen=True)
class Plan:
    """The numbers of a run; those of the published results by default."""

    variant: str = "easy"
    """of the grasp in clutter"""
    demonstrations: int = 20
    calibration: int = 20
    """expert episodes that no fit sees, for the threshold"""
    fresh: int = 40
    """expert episodes in which false alarms are counted"""
    rounds: int = 2
    episodes: int = 12
    """a round"""
    steps: int = 2000
    """of LeRobot's training, each time"""
    final: int = 40
    """scenes of a policy alone, always the same"""
    judged: int = 5
    """gated episodes in which judged and given actions are compared"""
    seed: int = 0


QUICK = Plan(
    demonstrations=3, calibration=3, fresh=3, rounds=1, episodes=2, steps=60, final=3, judged=1
)


def claim(folder: Path, plan: Any) -> None:
    """Make the folder that of `plan`, a dataclass; ParameterError where it is another plan's."""
    path = folder / "plan.json"
    wanted = plain(asdict(plan))
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        write_json(path, wanted)
    elif json.loads(path.read_text()) != wanted:
        raise ParameterError(f"{folder} holds the run of another plan; wanted an empty folder")
