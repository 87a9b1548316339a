"""What the keys of another tool's file mean here."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.track import Track
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.types import Actor, EpisodeInfo, Outcome, Purpose, Reason

_OURS = re.compile(r"images/[A-Za-z0-9][A-Za-z0-9_.-]*|features|action|reward|state|intervention")

UNTOLD = "untold"
"""the checkpoint of episodes that a policy drove of which the file does not say more"""


@dataclass(frozen=True)
class KeyMap:
    """Which of the file's keys are joined to which array of ours."""

    keys: Mapping[str, tuple[str, ...]]
    """by `images/CAMERA`, `features`, `action`, `reward`, `state` or `intervention`; the last axes
    of several keys are laid end to end"""

    @classmethod
    def parse(cls, words: Iterable[str]) -> "KeyMap":
        """Return the map that words spell, such as `images/top=img` and `features=pos,vel`.

        Raises ParameterError.
        """
        keys: dict[str, tuple[str, ...]] = {}
        for word in words:
            ours, _, theirs = word.partition("=")
            names = tuple(name for name in theirs.split(",") if name)
            if not _OURS.fullmatch(ours) or not names:
                raise ParameterError(
                    f"the key {word!r} is not OURS=THEIRS; wanted images/CAMERA, features, action, "
                    "reward, state or intervention, and keys of the file, such as "
                    "features=agent_pos,block_pos"
                )
            keys[ours] = names
        return cls(keys)

    def over(self, defaults: Mapping[str, tuple[str, ...]], track: Track) -> "KeyMap":
        """Return this map with those of `defaults` that the file has and that were not given."""
        there = {k: v for k, v in defaults.items() if all(name in track.keys for name in v)}
        return KeyMap({**there, **self.keys})

    def remarks(self, track: Track, outcome_by: str) -> Iterator[str]:
        """Yield a line that says what is taken of an episode, and one that says what is not.

        `outcome_by` is the key that tells the outcome; empty where none does.
        """
        meant = {**self.keys, **({"outcome": (outcome_by,)} if outcome_by else {})}
        pairs = (f"{ours}={','.join(theirs)}" for ours, theirs in meant.items())
        yield f"taken: {' '.join(pairs)}"
        taken = {name for theirs in meant.values() for name in theirs}
        # A part is named `KEY/NAME`, and its key alone is enough.
        left = [
            key
            for key in track.keys
            if key not in taken and not any(key.startswith(f"{whole}/") for whole in track.keys)
        ]
        if left := [*left, *track.beside]:
            yield f"not taken: {' '.join(left)}"


def interpret(track: Track, info: EpisodeInfo, outcome: Outcome, key_map: KeyMap) -> Recorded:
    """The episode as a demonstration: the file's action is what the expert said and did.

    Where an `intervention` is false the policy proposed and did it instead, and the episode is one
    of learning. A file that holds no observation after the last action gets the last one again.
    Raises StoreError where a key is missing or of a wrong shape.
    """
    if "action" not in key_map.keys:
        raise _missing("action", ("action",), track)
    length = track.length
    columns = {
        "features": np.zeros((length, 0), np.float32),
        "state": np.zeros((length, 0)),
        "reward": np.zeros((length, 1)),
        "intervention": np.ones((length, 1)),
        **{ours: _column(track, ours, theirs) for ours, theirs in key_map.keys.items()},
    }
    action = columns.pop("action")
    reward = columns.pop("reward")[:, 0]
    by_expert = columns.pop("intervention")[:, 0] > 0.5
    by_policy = ~by_expert
    if by_policy.any():
        info = replace(info, purpose=Purpose.LEARNING, checkpoint=UNTOLD)
    cameras = [ours for ours in columns if ours.startswith("images/")]
    header = Header(
        info=info,
        length=length,
        cameras={
            camera.removeprefix("images/"): (columns[camera].shape[1], columns[camera].shape[2])
            for camera in cameras
        },
        feature_size=columns["features"].shape[1],
        state_size=columns["state"].shape[1],
        action_size=action.shape[1],
        terminated=track.ending.terminated,
        truncated=track.ending.truncated,
        outcome=outcome,
        instruction=track.words,
        metrics={},
        expert_steps=int(by_expert.sum()),
        queries=int(by_expert.sum()),
        actors=tuple(Actor),
        reasons=tuple(Reason),
        limits=(),
        versions={},
        recorded_utc=datetime.now(UTC).isoformat(timespec="seconds"),
    )
    # What an expert alone recorded has none.
    intervention = by_expert & by_policy.any()
    expert, policy = (header.actors.index(each) for each in (Actor.EXPERT, Actor.POLICY))
    person, fixed = (header.reasons.index(each) for each in (Reason.PERSON, Reason.FIXED))
    return Recorded(
        header,
        {
            **columns,
            "time_s": np.arange(length) / info.control_rate_hz,
            "proposed": np.where(by_policy[:, None], action, np.float32(np.nan)),
            "has_proposed": by_policy,
            "labelled": np.where(by_expert[:, None], action, np.float32(np.nan)),
            "has_labelled": by_expert,
            "executed": action,
            "actor": np.where(by_expert, expert, policy).astype(np.uint8),
            "reason": np.where(intervention, person, fixed).astype(np.uint8),
            "intervention": intervention,
            "query": by_expert,
            "score": np.full(length, np.nan),
            "threshold": np.full(length, np.nan),
            "reward": reward,
            "final/time_s": np.array(length / info.control_rate_hz),
            **{
                f"final/{ours}": _final(track, ours, values, key_map.keys.get(ours, ()))
                for ours, values in columns.items()
            },
        },
    )


def _column(track: Track, ours: str, theirs: tuple[str, ...]) -> NDArray:
    """(T, ...) in our type."""
    parts = []
    for key in theirs:
        if key not in track.keys:
            raise _missing(ours, theirs, track)
        parts.append(np.asarray(track.read(key)))
        if len(parts[-1]) != track.length:
            raise StoreError(f"{key} has {len(parts[-1])} rows, the episode {track.length} steps")
    return _as_ours(ours, parts, theirs)


def _final(track: Track, ours: str, column: NDArray, theirs: tuple[str, ...]) -> NDArray:
    """(...) after the last action."""
    parts = [track.final(key) for key in theirs]
    known = [np.asarray(part)[None] for part in parts if part is not None]
    # Without one of its keys it is not known: the last of the column has to do.
    return _as_ours(ours, known, theirs)[0] if known and len(known) == len(parts) else column[-1]


def _as_ours(ours: str, parts: list[NDArray], theirs: tuple[str, ...]) -> NDArray:
    if ours.startswith("images/"):
        (image, *more) = parts
        if more or image.ndim != 4 or image.shape[-1] != 3:
            raise StoreError(
                f"{', '.join(theirs)} is {image.shape}; wanted one key of images (T, h, w, 3)"
            )
        # A film of bytes is large, and needs no copy.
        whole = image.astype(np.uint8, copy=False)
        if image.dtype != np.uint8 and not np.array_equal(whole, image):
            raise StoreError(
                f"{theirs[0]} is {image.dtype} and not in whole numbers 0 .. 255; "
                "wanted RGB in bytes"
            )
        return whole
    flat = [part.reshape(len(part), -1) for part in parts]
    if any(part.dtype.kind not in "biuf" for part in flat):
        raise StoreError(f"{', '.join(theirs)} holds no numbers; wanted an array of them")
    joined = np.concatenate(flat, axis=1)
    if ours in ("reward", "intervention") and joined.shape[1] != 1:
        raise StoreError(f"{', '.join(theirs)} has {joined.shape[1]} numbers a step; wanted one")
    return joined.astype(np.float64 if ours in ("state", "reward") else np.float32)


def _missing(ours: str, theirs: tuple[str, ...], track: Track) -> StoreError:
    wanted = ", ".join(key for key in theirs if key not in track.keys)
    return StoreError(
        f"the file has no key {wanted!r} for {ours}; it has {', '.join(track.keys)}: "
        f"give --keys {ours}=KEY"
    )


def numbered(info: EpisodeInfo, number: int) -> EpisodeInfo:
    """`info` for the episode in that place of the file."""
    return replace(info, index=number, seed=number)
