"""LeRobot's data sets: v3 written by LeRobot itself; v2.0, v2.1 and v3 read without it.

| feature | meaning |
|---|---|
| `observation.images.CAMERA` | image, lossless, before the action |
| `observation.state` | the features before the action |
| `action` | the action that was chosen for export |
| `next.reward`, `next.terminated`, `next.truncated`, `next.done`, `next.success` | of the action |
| `intervention` | whether somebody else than the policy acted, as LeRobot's own DAgger has it |
| `requested` | what the actor asked for, before the command filter: given again, it runs the same |
| `limited` | by how much the command filter changed the action at most, NaN where it did not |
| `NAME` | every other array of `layout`, by its name there |

A frame without an action has no place in it, so the observation after the last action is lost. The
headers of the episodes are in `meta/sheath.json`, which its loader does not look at.
"""

from collections.abc import Iterable
from pathlib import Path

from sheath_manip.dataset.exchange.formats import ForeignFile, Format
from sheath_manip.dataset.exchange.limits import FILM_TIMES_LARGER
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.recorded import Recorded

HEADERS = "meta/sheath.json"
_RENAMED = {"features": "observation.state", "reward": "next.reward"}


def feature_name(path: str) -> str:
    """Return the feature that holds an array of `layout` with a row for each step."""
    if path.startswith("images/"):
        return f"observation.images.{path.removeprefix('images/')}"
    return _RENAMED.get(path, path)


def _write(target: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    # Each way wants packages of its own.
    from sheath_manip.dataset.exchange.lerobot_writing import write

    write(target, episodes, action)


def _open(path: Path) -> ForeignFile:
    from sheath_manip.dataset.exchange.lerobot_reading import LeRobotDirectory

    return LeRobotDirectory(path)


FORMAT = Format(_write, _open, times_larger=FILM_TIMES_LARGER)
