"""One scene under one way of taking over: what came of it, and what it asked of the expert."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.takeovers.stretch import Stretch
from sheath_manip.files.json_files import plain, write_json
from sheath_manip.metrics import runs_of
from sheath_manip.types import Episode, Outcome


@dataclass(frozen=True)
class Trial:
    """An episode as the benchmark keeps it."""

    seed: int
    """of the scene"""
    failing: bool
    """whether the policy alone does not succeed there"""
    outcome: Outcome
    steps: int
    """of the whole episode"""
    turns: tuple[tuple[int, int], ...]
    """of the expert: (first step, number of steps) each"""

    @classmethod
    def of(cls, episode: Episode, failing: bool, first_step: int = 0) -> Self:
        """Return what an episode came to that went on from step `first_step` of the scene's."""
        runs = runs_of(episode.columns.intervention)
        turns = tuple((first_step + start, stop - start) for start, stop in runs)
        return cls(episode.info.seed, failing, episode.outcome, first_step + len(episode), turns)

    @classmethod
    def alone(cls, alone: Stretch, failing: bool) -> Self:
        """Return what a scene came to in which nobody took over."""
        return cls(alone.info.seed, failing, alone.outcome, len(alone), ())

    @property
    def fails(self) -> bool:
        """Whether it did not succeed: to be stuck until the time is over is to fail."""
        return self.outcome is not Outcome.SUCCESS

    @property
    def stuck(self) -> bool:
        """Whether the time was over before anything was decided."""
        return self.outcome is Outcome.TIME_LIMIT

    @property
    def expert_steps(self) -> int:
        """Steps in which the expert acted."""
        return sum(count for _, count in self.turns)


def write_trials(path: Path, trials: Mapping[str, Sequence[Trial]]) -> None:
    """Write the trials of several ways, by name, in one stroke."""
    write_json(path, plain({name: [asdict(each) for each in of] for name, of in trials.items()}))


def read_trials(path: Path) -> dict[str, list[Trial]]:
    """Read what `write_trials` wrote; raises StoreError for anything else."""
    try:
        return {
            name: [_trial(each) for each in of] for name, of in json.loads(path.read_text()).items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise StoreError(
            f"{path} holds no trials ({error}); remove it to have them run again"
        ) from error


def mean_takeovers(trials: Iterable[Trial]) -> float:
    """Takeovers an episode."""
    counts = [len(trial.turns) for trial in trials]
    return sum(counts) / len(counts) if counts else float("nan")


def mean_share(trials: Sequence[Trial]) -> float:
    """The expert's share of all steps."""
    steps = sum(trial.steps for trial in trials)
    return sum(trial.expert_steps for trial in trials) / steps if steps else float("nan")


def _trial(content: Mapping[str, Any]) -> Trial:
    turns = tuple((int(start), int(count)) for start, count in content["turns"])
    return Trial(**{**content, "outcome": Outcome(content["outcome"]), "turns": turns})
