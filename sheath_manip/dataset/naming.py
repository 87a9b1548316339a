"""The name of an episode's directory: deterministic, sortable, one for each episode of a run."""

import re
from urllib.parse import quote

from sheath_manip.types import EpisodeInfo, Purpose

LEFTOVER_PREFIX = ".tmp-"
"""of whatever is still being written"""

_NAME = re.compile(rf"({'|'.join(Purpose)})(-.+)?-s-?\d+-r-?\d+-i-?\d+-seed-?\d+")


def episode_name(info: EpisodeInfo) -> str:
    """Where the episode of `info` is kept, such as `learning-sheath-s0-r03-i007-seed12345`.

    Task and checkpoint are left out: one store holds one task, and a second run of the same episode
    must meet the first one's name.
    """
    # A method is free text; quoting keeps it one path component and keeps different ones apart.
    who = "-".join(part for part in (info.purpose.value, quote(info.method, safe="")) if part)
    return f"{who}-s{info.run_seed}-r{info.round:02d}-i{info.index:03d}-seed{info.seed}"


def is_episode_name(name: str) -> bool:
    """Whether `name` could have come from `episode_name`."""
    return _NAME.fullmatch(name) is not None
