"""A header as JSON, the attributes of its episode's zarr group, and back."""

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from sheath_manip.dataset.broken_steps import broken_from_json
from sheath_manip.dataset.faults import REMEDY, FaultError, FaultKind
from sheath_manip.dataset.header import CAMERA, Header, is_rate, require_sizes
from sheath_manip.dataset.naming import episode_name, is_session
from sheath_manip.dataset.space import Space
from sheath_manip.json_files import strict_float
from sheath_manip.types import Actor, EpisodeInfo, Outcome, Purpose, Reason

FORMAT = "sheath-episode"
GROUP_FILE = "zarr.json"
"""where zarr keeps a group's attributes"""
SCHEMA = 2
"""Raise it whenever a reader of the old one would misread the new one."""
READABLE = (1, SCHEMA)
"""Those of schema 1 tell neither variant nor session nor space."""
_UNTOLD = {"variant": "", "session": "", "space": None}


def to_attributes(header: Header) -> dict[str, Any]:
    """The header as JSON; `from_attributes` is its inverse."""
    fields = asdict(replace(header, space=None))
    info = fields.pop("info")
    if not header.broken:
        del fields["broken"]
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
    if attributes["length"] < 1 or not all(map(CAMERA.fullmatch, attributes["cameras"])):
        raise ValueError("wanted at least one step and plain camera names")
    if not is_rate(float(attributes["control_rate_hz"])):
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
        broken=broken_from_json(attributes.get("broken", ())),
    )
    require_sizes(header)
    return header


def _writer(attributes: Mapping[str, Any]) -> str:
    versions = attributes.get("versions")
    return str(versions.get("sheath-manip", "unknown")) if isinstance(versions, dict) else "unknown"
