"""A header as JSON, the attributes of its episode's zarr group, and back."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from sheath_manip.dataset.broken_steps import broken_from_json
from sheath_manip.dataset.digests import unsealed
from sheath_manip.dataset.faults import REMEDY, FaultError, FaultKind
from sheath_manip.dataset.fields import (
    MOST_STEPS,
    Fields,
    flag,
    named,
    number,
    one_of,
    rows_of,
    shown,
    whole,
    word,
)
from sheath_manip.dataset.header import CAMERA, Header, is_rate, require_sizes
from sheath_manip.dataset.layout import layout, require_bounds
from sheath_manip.dataset.naming import episode_name, is_session
from sheath_manip.dataset.space import Space
from sheath_manip.dataset.waits import waits_from_json
from sheath_manip.exceptions import StoreError
from sheath_manip.files.bounded_json import parse_json
from sheath_manip.files.json_files import strict_float
from sheath_manip.types import Actor, EpisodeInfo, Outcome, Purpose, Reason

FORMAT = "sheath-episode"
GROUP_FILE = "zarr.json"
"""where zarr keeps a group's attributes"""
SCHEMA = 2
"""Raise it whenever a reader of the old one would misread the new one."""
READABLE = (1, SCHEMA)
"""Those of schema 1 tell neither variant nor session nor space."""
MOST_BYTES = 4 << 20
"""of a file of attributes"""
_GROUP = {"zarr_format": 3, "node_type": "group"}
"""all that such a file has beside its attributes"""
_SEED = whole(-(2**64), 2**64)
_COUNT = whole(-(2**31), 2**31)
_SIZE = whole(0, 10**7)
_PIXELS = whole(0, 2**16)
_MOST_WORDS = 256
"""of cameras, metrics, limits, signals and kinds"""


def to_attributes(header: Header) -> dict[str, Any]:
    """The header as JSON; `from_attributes` is its inverse."""
    fields = asdict(replace(header, space=None, digests=None, checksums=None))
    info = fields.pop("info")
    # What few episodes have is written for those alone.
    for name in ("broken", "waits", "instruction", "signals"):
        if not fields[name]:
            del fields[name]
    del fields["digests"], fields["checksums"]
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


def parse_header(name: str, content: bytes) -> Header:
    """The header of the episode `name` from its zarr.json; raises FaultError."""
    header = header_in(name, content)
    if episode_name(header.info) != name:
        raise FaultError(
            name,
            FaultKind.MISMATCH,
            f"it holds the episode {episode_name(header.info)}; give it back that name: "
            "`sheath data repair`",
        )
    return header


def header_in(name: str, content: bytes) -> Header:
    """The header in a zarr.json, whatever episode it is of; raises FaultError, told of `name`."""
    try:
        group = parse_json(content)
    except ValueError as error:
        raise FaultError(
            name, FaultKind.UNREADABLE, f"its zarr.json does not decode ({error}); {REMEDY}"
        ) from error
    attributes = group.pop("attributes", {}) if isinstance(group, dict) else {}
    _require_ours(name, attributes)
    if group != _GROUP:
        raise FaultError(
            name, FaultKind.MISMATCH, f"its zarr.json is no group of zarr's format 3; {REMEDY}"
        )
    try:
        told, seals = unsealed(attributes)
    except ValueError as error:
        raise FaultError(
            name, FaultKind.MISMATCH, f"its header is not as it was written: {error}; {REMEDY}"
        ) from error
    header = from_attributes(name, told)
    if seals is None:
        return header
    if seals.digests.keys() != {spec.path for spec in layout(header)}:
        raise FaultError(
            name, FaultKind.MISMATCH, f"it tells digests of other arrays than it has; {REMEDY}"
        )
    return replace(header, digests=seals.digests, checksums=seals.checksums)


def from_attributes(name: str, attributes: Any) -> Header:
    """The inverse of `to_attributes`; raises FaultError, told of `name`, where it is none."""
    _require_ours(name, attributes)
    try:
        return _from_attributes(attributes)
    except ValueError as error:
        raise FaultError(
            name, FaultKind.UNREADABLE, f"its header is broken ({error}); {REMEDY}"
        ) from error


def require_storable(header: Header) -> None:
    """Raise StoreError where a header, once written, could not be read again."""
    try:
        _from_attributes(to_attributes(header))
    except ValueError as error:
        name = episode_name(header.info)
        raise StoreError(f"{name}: {error}; mend the environment's spec") from error


def _require_ours(name: str, attributes: Any) -> None:
    if not isinstance(attributes, dict) or attributes.get("format") != FORMAT:
        raise FaultError(
            name,
            FaultKind.FOREIGN,
            f"wanted a zarr group of format {FORMAT!r}, found another; move it away",
        )
    schema = attributes.get("schema")
    if type(schema) is not int or schema not in READABLE:
        raise FaultError(
            name,
            FaultKind.SCHEMA,
            f"wanted schema {' or '.join(map(str, READABLE))}, found {shown(schema)}; "
            "read it with the version of sheath-manip that wrote it "
            f"({_writer(attributes)})",
        )


def _from_attributes(attributes: Mapping[str, Any]) -> Header:
    fields = Fields(attributes)
    fields.take("format", word)
    schema = fields.take("schema", whole(1, SCHEMA))
    # Before schema 2 nobody said, and that is not the same as the default.
    untold = {"absent": ""} if schema == 1 else {}
    length = fields.take("length", whole(1, MOST_STEPS))
    header = Header(
        info=EpisodeInfo(
            task=fields.take("task", word),
            seed=fields.take("seed", _SEED),
            purpose=fields.take("purpose", one_of(Purpose)),
            control_rate_hz=fields.take("control_rate_hz", _rate),
            method=fields.take("method", word),
            round=fields.take("round", _COUNT),
            index=fields.take("index", _COUNT),
            run_seed=fields.take("run_seed", _SEED),
            checkpoint=fields.take("checkpoint", word),
            variant=fields.take("variant", word, **untold),
            session=fields.take("session", _session, **untold),
        ),
        length=length,
        cameras=fields.take("cameras", _cameras),
        feature_size=fields.take("feature_size", _SIZE),
        state_size=fields.take("state_size", _SIZE),
        action_size=fields.take("action_size", _SIZE),
        terminated=fields.take("terminated", flag),
        truncated=fields.take("truncated", flag),
        outcome=fields.take("outcome", one_of(Outcome)),
        metrics=fields.take("metrics", named(number, _MOST_WORDS)),
        expert_steps=fields.take("expert_steps", whole(0, length)),
        queries=fields.take("queries", whole(0, length)),
        actors=fields.take("actors", rows_of(one_of(Actor), _MOST_WORDS)),
        reasons=fields.take("reasons", rows_of(one_of(Reason), _MOST_WORDS)),
        limits=fields.take("limits", rows_of(word, _MOST_WORDS), absent=()),
        versions=fields.take("versions", named(word, _MOST_WORDS)),
        recorded_utc=fields.take("recorded_utc", word),
        space=fields.take("space", _space, **({"absent": None} if schema == 1 else {})),
        broken=fields.take("broken", broken_from_json, absent=()),
        waits=fields.take("waits", waits_from_json, absent=()),
        instruction=fields.take("instruction", word, absent=""),
        signals=fields.take("signals", rows_of(word, _MOST_WORDS), absent=()),
    )
    if fields.take("success", flag) is not (header.outcome is Outcome.SUCCESS):
        raise ValueError(f"success: it tells another than the outcome {header.outcome}")
    fields.require_empty()
    require_sizes(header)
    require_bounds(header)
    return header


def _rate(value: Any) -> float:
    rate_hz = number(value)
    if not is_rate(rate_hz):
        raise ValueError(f"wanted a control rate above 0 Hz, found {shown(value)}")
    return rate_hz


def _session(value: Any) -> str:
    if not is_session(word(value)):
        raise ValueError(f"wanted letters and digits, found {shown(value)}")
    return value


def _cameras(value: Any) -> dict[str, tuple[int, int]]:
    cameras = named(rows_of(_PIXELS, 2), _MOST_WORDS)(value)
    for camera, size in cameras.items():
        if not CAMERA.fullmatch(camera) or len(size) != 2:
            raise ValueError(f"wanted plain names with height and width, found {shown(camera)}")
    return cameras


def _space(value: Any) -> Space | None:
    return None if value is None else Space.from_json(value)


def _writer(attributes: Mapping[str, Any]) -> str:
    versions = attributes.get("versions")
    version = versions.get("sheath-manip") if isinstance(versions, dict) else None
    return version[:40] if isinstance(version, str) else "unknown"
