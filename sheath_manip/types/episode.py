"""One episode: where it comes from, its steps, how it ended."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types.columns import Columns, stacked
from sheath_manip.types.spec import TaskSpec
from sheath_manip.types.step import Breakdown, Observation, Step


class Outcome(StrEnum):
    """The outcome of an episode: how it ended, in the task's own terms, or as it was cut short."""

    SUCCESS = "success"
    """the task was done"""
    FAILURE = "failure"
    """the task ended it as failed"""
    TIME_LIMIT = "time-limit"
    """neither before the last step"""
    ERROR = "error"
    """something broke down and nobody was left to act: no failure of the task, nothing to learn"""


class Purpose(StrEnum):
    """The purpose that an episode was recorded for.

    Episodes of different purposes never share a seed.
    """

    DEMONSTRATION = "demonstration"
    """the expert drives from first to last, to learn from"""
    CALIBRATION = "calibration"
    """the same, held out to set the threshold"""
    LEARNING = "learning"
    """under the gate, in a round of learning"""
    EVALUATION = "evaluation"
    """on scenes that nothing is learned from"""


@dataclass(frozen=True)
class EpisodeInfo:
    """The origin of an episode: enough to run it again."""

    task: str
    seed: int
    """of the scene"""
    purpose: Purpose
    control_rate_hz: float
    method: str = ""
    round: int = 0
    index: int = 0
    """within its round"""
    run_seed: int = 0
    """of the training run it belongs to"""
    checkpoint: str = ""
    """content hash of the policy and gate that drove it; empty where none did"""
    variant: str = "default"
    """of the task; empty where a recording does not say, as those of before there was this field"""
    session: str = ""
    """letters and digits that tell recordings by hand of one scene apart; empty where the same run
    gives the same episode again"""

    @classmethod
    def of(
        cls,
        spec: TaskSpec,
        *,
        variant: str,
        seed: int,
        purpose: Purpose,
        method: str = "",
        round: int = 0,
        index: int = 0,
        run_seed: int = 0,
        checkpoint: str = "",
        session: str = "",
    ) -> Self:
        """Return the info of an episode of the task of `spec`, in the `variant` that has it.

        Args:
            spec: of the task; gives its name and control rate.
            variant: of the task.
            seed: of the scene.
            purpose: of the recording; `DEMONSTRATION` and `CALIBRATION` are the expert's alone.
            method: that is learning; empty where none is, as for demonstrations.
            round: of learning, from 0.
            index: within its round.
            run_seed: of the training run.
            checkpoint: digest of policy and gate; empty where they are from no checkpoint.
            session: tells recordings by hand of one scene apart; empty for all others.
        """
        return cls(
            task=spec.name,
            seed=seed,
            purpose=purpose,
            control_rate_hz=spec.control_rate_hz,
            method=method,
            round=round,
            index=index,
            run_seed=run_seed,
            checkpoint=checkpoint,
            variant=variant,
            session=session,
        )


@dataclass(frozen=True, eq=False)
class Episode:
    """T steps and T+1 observations: a table, of which a `Step` is a row."""

    info: EpisodeInfo
    steps: Sequence[Step]
    final_observation: Observation
    final_state: NDArray[np.float64]
    terminated: bool
    """the task reached an end of its own (dm_env: discount 0)"""
    truncated: bool
    """the time ran out (dm_env: discount 1)"""
    outcome: Outcome
    metrics: Mapping[str, float] = field(default_factory=dict)
    cut_short_by: Breakdown | None = None
    """what ended an episode whose outcome is an error; its final observation is the last one that
    was seen, and its final state NaN where there was none to be had"""

    def __len__(self) -> int:
        return len(self.steps)

    @cached_property
    def columns(self) -> Columns:
        """The steps by column, but for their images; raises ValueError where they disagree."""
        return Columns.of(self.steps, driven=bool(self.info.checkpoint))

    def images(self, camera: str) -> NDArray[np.uint8]:
        """(T, h, w, 3) what a camera saw before each action; ValueError for several shapes."""
        return stacked([step.observation.images[camera] for step in self.steps])
