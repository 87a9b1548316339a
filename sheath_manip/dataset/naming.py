"""The name of an episode's directory: deterministic, sortable, one for each episode of a run."""

import re
import uuid
from dataclasses import replace
from urllib.parse import quote

from sheath_manip.types import EpisodeInfo, Purpose

LEFTOVER_PREFIX = ".tmp-"
"""of whatever is still being written"""

_NAME = re.compile(
    rf"({'|'.join(Purpose)})(-.+)?-s-?\d+-r-?\d+-i-?\d+-seed-?\d+(-session[0-9A-Za-z]+)?"
)
_CUT_SHORT = "error"
Scene = tuple[str, int, int]
_SESSION = re.compile(r"[0-9A-Za-z]*")


def episode_name(info: EpisodeInfo) -> str:
    """Return the name of the episode of `info`, such as `learning-sheath-s0-r03-i007-seed12345`.

    Task, variant and checkpoint are left out: a second run of the same episode must meet the first
    one's name. A recording by hand ends in `-session` and the name of that.
    """
    # A method is free text; quoting keeps it one path component and keeps different ones apart.
    who = "-".join(part for part in (info.purpose.value, quote(info.method, safe="")) if part)
    session = f"-session{quote(info.session, safe='')}" if info.session else ""
    return f"{who}-s{info.run_seed}-r{info.round:02d}-i{info.index:03d}-seed{info.seed}{session}"


def scene_of(info: EpisodeInfo) -> Scene:
    """Return variant, seed and place of a scene, which all recordings of it have in common."""
    return info.variant, info.seed, info.index


def scene_name(info: EpisodeInfo) -> str:
    """Return what the names of all recordings of one scene begin with, whatever their session."""
    return episode_name(replace(info, session=""))


def split_session(name: str) -> tuple[str, str]:
    """The `scene_name` in an episode's name, and its session, empty where it has none."""
    # A session has no dash in it, and what is before it ends in a number.
    before, dash, last = name.rpartition("-session")
    return (before, last) if dash and "-" not in last else (name, "")


def is_episode_name(name: str) -> bool:
    """Return whether `name` could have come from `episode_name`."""
    return _NAME.fullmatch(name) is not None


def is_session(text: str) -> bool:
    """Return whether `text` may tell a session, or be none: letters and digits only."""
    return _SESSION.fullmatch(text) is not None


def error_session(session: str) -> str:
    """Return a session for an attempt at an episode that was cut short: a new one each time.

    Its name keeps the attempt apart from the episode, which is still to be had.
    """
    return f"{session}{_CUT_SHORT}{uuid.uuid4().hex[:12]}"


def is_cut_short(session: str) -> bool:
    """Tell whether `session` is one of `error_session`; those of people are hexadecimal."""
    return _CUT_SHORT in session
