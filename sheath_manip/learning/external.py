"""What the file of a gate tells of its policy, which is not in the file."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.fields import Fields, named, number, rows_of, whole, word
from sheath_manip.dataset.recorded_task import task_of
from sheath_manip.dataset.space import Space
from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays, PredictingPolicy, Reader
from sheath_manip.rollout.guard import ask
from sheath_manip.seeding import generator
from sheath_manip.types import Observations
from sheath_manip.types.seen import Seen

MADE_UP = 3
"""states that a policy is shown, to tell it from another"""
CLOSE = 0.01
"""by which share of their size its answers there may differ: another machine rounds otherwise"""
MOST_PIXELS = 1 << 26
"""of all cameras together"""
MOST_NUMBERS = 1 << 20
"""of features or actions"""


@dataclass(frozen=True)
class External:
    """A policy that is kept elsewhere."""

    named: str
    """where it was found, such as `mine.py:act`"""
    data: str
    """where the episodes lay that its gate was fitted to"""
    recorded: RecordedSpec
    """what it sees and does, as its data told"""
    instruction: str = ""
    """what the robot was told in that data; empty where nothing was said"""

    def to_json(self) -> dict[str, Any]:
        """Return it as strict JSON; `from_json` is the inverse."""
        recorded = self.recorded
        return {
            "named": self.named,
            "data": self.data,
            "control_rate_hz": float(recorded.control_rate_hz),
            "cameras": {name: list(size) for name, size in recorded.cameras.items()},
            "feature_size": recorded.feature_size,
            "action_size": recorded.action_size,
            "space": None if recorded.space is None else recorded.space.to_json(),
            "instruction": self.instruction,
        }

    @classmethod
    def from_json(cls, task: str, value: Any) -> Self:
        """Return what `to_json` gave; raises ValueError for anything else."""
        fields = Fields(value)
        read_size = rows_of(whole(1, MOST_PIXELS), 2)
        recorded = RecordedSpec(
            task=task,
            control_rate_hz=fields.take("control_rate_hz", number),
            cameras=fields.take("cameras", named(read_size, 256)),
            feature_size=fields.take("feature_size", whole(0, MOST_NUMBERS)),
            action_size=fields.take("action_size", whole(1, MOST_NUMBERS)),
            space=fields.take("space", _space),
        )
        named_by, data = fields.take("named", word), fields.take("data", word)
        external = cls(named_by, data, recorded, fields.take("instruction", word))
        fields.require_empty()
        external._require_sizes()
        return external

    def _require_sizes(self) -> None:
        recorded, space = self.recorded, self.recorded.space
        if any(len(size) != 2 for size in recorded.cameras.values()):
            raise ValueError("cameras: wanted a height and a width of each")
        pixels = sum(map(math.prod, recorded.cameras.values()))
        if pixels > MOST_PIXELS:
            raise ValueError(f"cameras: {pixels} pixels; wanted at most {MOST_PIXELS}")
        told = (len(space.feature_names), len(space.action_names)) if space else None
        if told not in (None, (recorded.feature_size, recorded.action_size)):
            raise ValueError("space: wanted as many names as there are features and actions")


def _space(value: Any) -> Space | None:
    return None if value is None else Space.from_json(value)


def looks_at_made_up(
    policy: PredictingPolicy, external: External, readers: Sequence[Reader]
) -> Seen:
    """Return a few made-up states, always the same ones, as `policy` sees them.

    Raises ParameterError where it proposes actions of another size than it should, and SheathError
    where it breaks down.
    """
    spec, rng = task_of(external.recorded), generator("made-up states")
    observations = Observations(
        {
            camera: rng.integers(0, 256, (MADE_UP, *size, 3), dtype=np.uint8)
            for camera, size in spec.cameras.items()
        },
        rng.normal(size=(MADE_UP, len(spec.feature_names))).astype(np.float32),
        (external.instruction,) * MADE_UP if external.instruction else None,
    )
    proposal = ask("policy", policy.predict, observations)
    wanted = (MADE_UP, len(spec.action.names))
    if np.shape(proposal.now) != wanted:
        raise ParameterError(
            f"the policy proposes actions of shape {np.shape(proposal.now)} in {MADE_UP} states; "
            f"wanted {wanted}"
        )
    readings = {reader: reader(observations, proposal) for reader in readers}
    return Seen(observations.features, proposal.now, readings)


def answers_of(seen: Seen, readers: Sequence[Reader]) -> Arrays:
    """Return what tells a policy from another: its actions, and what a gate reads of its looks."""
    read = {f"reading {place}": seen.readings[reader] for place, reader in enumerate(readers)}
    return {"actions": seen.actions, **read}


def answers_alike(told: Arrays, given: Arrays) -> bool:
    """Return whether two policies answer alike."""
    return told.keys() == given.keys() and all(
        _alike(np.asarray(told[name]), np.asarray(given[name])) for name in told
    )


def _alike(told: np.ndarray, given: np.ndarray) -> bool:
    if told.shape != given.shape or told.dtype.kind not in "biuf":
        return False
    size = float(np.abs(told).mean()) if told.size else 0.0
    off = float(np.abs(told - given).mean()) if told.size else 0.0
    return off <= CLOSE * size + 1e-6
