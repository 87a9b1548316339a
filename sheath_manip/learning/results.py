"""What one round of learning showed, and its file."""

import dataclasses
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

from sheath_manip.exceptions import StoreError
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.theory import Bound
from sheath_manip.metrics import EpisodeRecord
from sheath_manip.types import Outcome

EXPERT = "expert"
"""the name under which demonstrations, calibration episodes and round 0 are stored"""


@dataclass(frozen=True)
class RoundResult:
    """One round of one method from one training seed. Round 0 is the demonstrations."""

    method: str
    run_seed: int
    round: int
    checkpoint: str
    """digest of the checkpoint fitted at the end of the round"""
    executed: tuple[EpisodeRecord, ...]
    """what really ran in the round: the last policy under its gate"""
    policy: tuple[EpisodeRecord, ...]
    """the new policy alone on held-out scenes"""
    final: tuple[EpisodeRecord, ...]
    """the last round's policy alone on the scenes of the task's `final` variant"""
    false_alarm_rate: float
    """share of the steps of new expert episodes that lie below the threshold"""
    missed_rate: float
    """of the labelled steps at which the policy's action was not the expert's, the share it acted
    in"""
    surrogate_loss: float
    """of the policy that drove, over the labelled states visited; NaN where there is none"""
    bound: Bound
    threshold: float
    states: int
    """labelled states aggregated so far"""
    wall_s: float


@runtime_checkable
class RoundListener(Protocol):
    """A listener that wants to know what each round of learning came to."""

    def on_round(self, result: RoundResult) -> None:
        """Called after each round, and of those that were done before a run was resumed."""
        ...


def write_result(path: Path, result: RoundResult) -> None:
    """Write atomically."""
    write_json(path, dataclasses.asdict(result))


def read_result(path: Path) -> RoundResult:
    """Raises StoreError for a file that is missing or no result."""
    try:
        fields = json.loads(path.read_text())
        for name in ("executed", "policy", "final"):
            fields[name] = tuple(
                EpisodeRecord(
                    **{
                        **record,
                        "outcome": Outcome(record["outcome"]),
                        "turns": tuple(record.get("turns", ())),
                    }
                )
                for record in fields[name]
            )
        return RoundResult(**{**fields, "bound": Bound(**fields["bound"])})
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise StoreError(
            f"{path} is no result of a round ({error}); remove it to have the round measured again"
        ) from error


def round_path(runs: Path, run_seed: int, method: str, number: int, suffix: str) -> Path:
    """Return where a round's checkpoint (`npz`) or its figures (`json`) lie under `runs`."""
    return runs / f"s{run_seed}" / method / f"round-{number:02d}.{suffix}"


def round_results(runs: Path, run_seed: int, method: str) -> list[RoundResult]:
    """Return all rounds that a method has finished, the shared round 0 first."""
    results = [read_result(round_path(runs, run_seed, EXPERT, 0, "json"))]
    while (path := round_path(runs, run_seed, method, len(results), "json")).exists():
        results.append(read_result(path))
    return results
