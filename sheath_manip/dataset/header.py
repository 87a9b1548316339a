"""An episode's header: all of it that is no array, kept as the attributes of its zarr group."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from importlib import metadata

from sheath_manip.dataset.broken_steps import BrokenSteps, broken_steps
from sheath_manip.dataset.naming import episode_name, is_session
from sheath_manip.dataset.space import Space
from sheath_manip.dataset.waits import Wait, waits_of
from sheath_manip.exceptions import StoreError
from sheath_manip.types import (
    ACTORS,
    REASONS,
    Actor,
    Columns,
    Episode,
    EpisodeInfo,
    Outcome,
    Reason,
)

# A camera is a folder of the group, on any system.
CAMERA = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
LEAST_RATE_HZ, MOST_RATE_HZ = 1e-3, 1e6
_PACKAGES = ("sheath-manip", "mujoco", "numpy", "zarr")


@dataclass(frozen=True)
class Header:
    """An episode's header: what must be known of it before one of its arrays is read."""

    info: EpisodeInfo
    length: int
    """T, in control steps"""
    cameras: Mapping[str, tuple[int, int]]
    """(height, width) in pixels, by camera"""
    feature_size: int
    state_size: int
    action_size: int
    terminated: bool
    truncated: bool
    outcome: Outcome
    metrics: Mapping[str, float]
    """NaN and infinity are kept, but not which of the many NaNs it was"""
    expert_steps: int
    """steps in which the expert acted"""
    queries: int
    """steps in which the gate asked for a label"""
    actors: tuple[Actor, ...]
    """what the codes in the array `actor` stand for"""
    reasons: tuple[Reason, ...]
    """what the codes in the array `reason` stand for"""
    limits: tuple[str, ...]
    """the columns of the array `limited`, sorted: limits of the command filter that acted; episodes
    of before there was one have none"""
    versions: Mapping[str, str]
    """of the packages that wrote it"""
    recorded_utc: str
    """ISO 8601"""
    space: Space | None = None
    """what features and actions mean; None where the recording does not say"""
    broken: tuple[BrokenSteps, ...] = ()
    """what broke down, and when; what cut the episode short at a step after its last one"""
    waits: tuple[Wait, ...] = ()
    """when the robot stood still and waited for a person"""
    instruction: str = ""
    """what the robot was told to do when the episode began; empty where nothing was said"""
    signals: tuple[str, ...] = ()
    """the columns of the array `signals`, sorted: what the gate's score was made of; empty for
    episodes without such a gate, and of before this was recorded"""
    digests: Mapping[str, str] | None = field(default=None, compare=False)
    """of each array, by its path, as they were written; None where the recording does not say"""
    checksums: Mapping[str, str] | None = field(default=None, compare=False)
    """of the checksums of its blocks, by its path; None where the recording does not say"""


def header_of(episode: Episode, space: Space | None = None) -> Header:
    """The header of `episode`, whose features and actions mean what `space` says.

    Raises StoreError where it has no step, no control rate, a camera of an odd name or a session
    that is no word, and where `space` is of other sizes.
    """
    name = episode_name(episode.info)
    if not episode.steps:
        raise StoreError(f"{name}: wanted at least one step, the episode has none")
    if not is_rate(episode.info.control_rate_hz):
        raise StoreError(
            f"{name}: wanted a control rate of {LEAST_RATE_HZ:g} .. {MOST_RATE_HZ:g} Hz, got "
            f"{episode.info.control_rate_hz}"
        )
    for camera in episode.final_observation.images:
        if not CAMERA.fullmatch(camera):
            raise StoreError(
                f"{name}: wanted a camera name of letters, digits and _.- only, got {camera!r}"
            )
    if not is_session(episode.info.session):
        raise StoreError(
            f"{name}: wanted a session of letters and digits, got {episode.info.session!r}"
        )
    columns = columns_of(episode)
    header = Header(
        info=episode.info,
        length=len(episode),
        cameras={
            camera: (image.shape[0], image.shape[1])
            for camera, image in episode.final_observation.images.items()
        },
        feature_size=episode.final_observation.features.size,
        state_size=episode.final_state.size,
        action_size=episode.steps[0].executed.size,
        terminated=bool(episode.terminated),
        truncated=bool(episode.truncated),
        outcome=Outcome(episode.outcome),
        metrics={name: float(value) for name, value in episode.metrics.items()},
        expert_steps=int(columns.in_place_of_policy.sum()),
        queries=int(columns.query.sum()),
        actors=ACTORS,
        reasons=REASONS,
        limits=tuple(sorted({each.limit for step in episode.steps for each in step.limited})),
        versions={name: _version(name) for name in _PACKAGES},
        recorded_utc=datetime.now(UTC).isoformat(timespec="seconds"),
        space=space,
        broken=broken_steps(episode),
        waits=waits_of(episode),
        instruction=episode.steps[0].observation.instruction,
        signals=tuple(columns.signals),
    )
    try:
        require_sizes(header)
    except ValueError as error:
        raise StoreError(f"{name}: {error}; mend the environment's spec") from error
    return header


def columns_of(episode: Episode) -> Columns:
    """Return the columns of `episode`; raises StoreError where its steps disagree."""
    try:
        return episode.columns
    except ValueError as error:
        name = episode_name(episode.info)
        raise StoreError(f"{name}: its steps have arrays of different shapes ({error})") from error


def require_sizes(header: Header) -> None:
    """Raise ValueError where the space is not of the arrays' sizes."""
    if header.space is None:
        return
    for what, names, size in (
        ("features", header.space.feature_names, header.feature_size),
        ("actions", header.space.action_names, header.action_size),
    ):
        if len(names) != size:
            raise ValueError(f"wanted the names of {size} {what}, got {len(names)}")


def is_rate(rate_hz: float) -> bool:
    """Whether a control rate is one that a robot or a simulation could have."""
    return LEAST_RATE_HZ <= rate_hz <= MOST_RATE_HZ


@cache
def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""
