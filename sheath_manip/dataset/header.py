"""An episode's header: all of it that is no array, kept as the attributes of its zarr group."""

import json
import math
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from sheath_manip.dataset.faults import REMEDY, FaultError, FaultKind
from sheath_manip.dataset.naming import episode_name, is_session
from sheath_manip.dataset.space import Space
from sheath_manip.exceptions import StoreError
from sheath_manip.json_files import strict_float
from sheath_manip.types import (
    ACTORS,
    REASONS,
    Actor,
    Columns,
    Episode,
    EpisodeInfo,
    Outcome,
    Purpose,
    Reason,
)

FORMAT = "sheath-episode"
GROUP_FILE = "zarr.json"
"""where zarr keeps a group's attributes"""
SCHEMA = 2
"""Raise it whenever a reader of the old one would misread the new one."""
READABLE = (1, SCHEMA)
"""Those of schema 1 tell neither variant nor session nor space."""

# A camera is a folder of the group, on any system.
_CAMERA = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
_UNTOLD = {"variant": "", "session": "", "space": None}
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


def header_of(episode: Episode, space: Space | None = None) -> Header:
    """The header of `episode`, whose features and actions mean what `space` says.

    Raises StoreError where it has no step, no control rate, a camera of an odd name or a session
    that is no word, and where `space` is of other sizes.
    """
    name = episode_name(episode.info)
    if not episode.steps:
        raise StoreError(f"{name}: wanted at least one step, the episode has none")
    if not _is_rate(episode.info.control_rate_hz):
        raise StoreError(
            f"{name}: wanted a control rate above 0 Hz, got {episode.info.control_rate_hz}"
        )
    for camera in episode.final_observation.images:
        if not _CAMERA.fullmatch(camera):
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
    )
    try:
        _require_sizes(header)
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


def to_attributes(header: Header) -> dict[str, Any]:
    """The header as JSON; `from_attributes` is its inverse."""
    fields = asdict(replace(header, space=None))
    info = fields.pop("info")
    for name in ("seed", "round", "index", "run_seed"):
        # A seed often comes from numpy, whose integers JSON does not take.
        info[name] = int(info[name])
    return {
        "format": FORMAT,
        "schema": SCHEMA,
        **info,
        **fields,
        "control_rate_hz": float(header.info.control_rate_hz),
        "metrics": {name: strict_float(value) for name, value in header.metrics.items()},
        "success": header.outcome is Outcome.SUCCESS,
        "space": None if header.space is None else header.space.to_json(),
    }


def read_header(directory: Path) -> Header:
    """The header of the episode in `directory`; raises FaultError where there is none to be had."""
    name = directory.name
    try:
        content = (directory / GROUP_FILE).read_bytes()
    except (FileNotFoundError, NotADirectoryError) as error:
        raise FaultError(
            name,
            FaultKind.FOREIGN,
            "wanted an episode, found no zarr.json in it; see `sheath data list`",
        ) from error
    except OSError as error:
        raise FaultError(
            name, FaultKind.UNREADABLE, f"its zarr.json cannot be read ({error}); {REMEDY}"
        ) from error
    return parse_header(name, content)


def parse_header(name: str, content: bytes) -> Header:
    """The header of the episode `name` from its zarr.json; raises FaultError as `read_header`."""
    try:
        group = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise FaultError(
            name, FaultKind.UNREADABLE, f"its zarr.json does not decode ({error}); {REMEDY}"
        ) from error
    header = from_attributes(name, group.get("attributes") if isinstance(group, dict) else None)
    if episode_name(header.info) != name:
        raise FaultError(
            name,
            FaultKind.MISMATCH,
            f"it holds the episode {episode_name(header.info)}; give it back that name: "
            "`sheath data repair`",
        )
    return header


def from_attributes(name: str, attributes: Any) -> Header:
    """The inverse of `to_attributes`; raises FaultError, told of `name`, where it is none."""
    if not isinstance(attributes, dict) or attributes.get("format") != FORMAT:
        raise FaultError(
            name,
            FaultKind.FOREIGN,
            f"wanted a zarr group of format {FORMAT!r}, found another; move it away",
        )
    if attributes.get("schema") not in READABLE:
        raise FaultError(
            name,
            FaultKind.SCHEMA,
            f"wanted schema {' or '.join(map(str, READABLE))}, found {attributes.get('schema')}; "
            "read it with the version of sheath-manip that wrote it "
            f"({_writer(attributes)})",
        )
    try:
        return _from_attributes(attributes)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise FaultError(
            name,
            FaultKind.UNREADABLE,
            f"its header is broken ({type(error).__name__}: {error}); {REMEDY}",
        ) from error


def _from_attributes(attributes: Mapping[str, Any]) -> Header:
    if attributes["length"] < 1 or not all(map(_CAMERA.fullmatch, attributes["cameras"])):
        raise ValueError("wanted at least one step and plain camera names")
    if not _is_rate(float(attributes["control_rate_hz"])):
        raise ValueError(f"wanted a control rate above 0 Hz, found {attributes['control_rate_hz']}")
    for flag in ("terminated", "truncated"):
        if not isinstance(attributes[flag], bool):
            raise TypeError(f"wanted true or false for {flag}, found {attributes[flag]!r}")
    # Before schema 2 nobody said, and that is not the same as the default.
    told = attributes if attributes["schema"] != 1 else _UNTOLD
    if not is_session(str(told["session"])):
        raise ValueError(f"wanted a session of letters and digits, found {told['session']!r}")
    header = Header(
        info=EpisodeInfo(
            task=str(attributes["task"]),
            seed=int(attributes["seed"]),
            purpose=Purpose(attributes["purpose"]),
            control_rate_hz=float(attributes["control_rate_hz"]),
            method=str(attributes["method"]),
            round=int(attributes["round"]),
            index=int(attributes["index"]),
            run_seed=int(attributes["run_seed"]),
            checkpoint=str(attributes["checkpoint"]),
            variant=str(told["variant"]),
            session=str(told["session"]),
        ),
        length=int(attributes["length"]),
        cameras={
            camera: (int(height), int(width))
            for camera, (height, width) in attributes["cameras"].items()
        },
        feature_size=int(attributes["feature_size"]),
        state_size=int(attributes["state_size"]),
        action_size=int(attributes["action_size"]),
        terminated=attributes["terminated"],
        truncated=attributes["truncated"],
        outcome=Outcome(attributes["outcome"]),
        # float() reads both a JSON number and the names that `strict_float` gives to the rest.
        metrics={name: float(value) for name, value in attributes["metrics"].items()},
        expert_steps=int(attributes["expert_steps"]),
        queries=int(attributes["queries"]),
        actors=tuple(Actor(value) for value in attributes["actors"]),
        reasons=tuple(Reason(value) for value in attributes["reasons"]),
        limits=tuple(str(value) for value in attributes.get("limits", ())),
        versions={name: str(value) for name, value in attributes["versions"].items()},
        recorded_utc=str(attributes["recorded_utc"]),
        space=None if told["space"] is None else Space.from_json(told["space"]),
    )
    _require_sizes(header)
    return header


def _require_sizes(header: Header) -> None:
    """Raise ValueError where the space is not of the arrays' sizes."""
    if header.space is None:
        return
    for what, names, size in (
        ("features", header.space.feature_names, header.feature_size),
        ("actions", header.space.action_names, header.action_size),
    ):
        if len(names) != size:
            raise ValueError(f"wanted the names of {size} {what}, got {len(names)}")


def _is_rate(rate_hz: float) -> bool:
    return 0 < rate_hz < math.inf


@cache
def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""


def _writer(attributes: Mapping[str, Any]) -> str:
    versions = attributes.get("versions")
    return str(versions.get("sheath-manip", "unknown")) if isinstance(versions, dict) else "unknown"
