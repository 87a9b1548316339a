"""Recordings by hand: two of one scene are two episodes, and need names of their own."""

import uuid
from collections.abc import Iterable
from dataclasses import replace

from sheath_manip.dataset.naming import episode_name, is_cut_short, split_session
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.types import EpisodeInfo

DIGITS = 12
"""of the hexadecimal name of a session"""


def new_session() -> str:
    """Return a name that no other session has, on any day and any machine."""
    return uuid.uuid4().hex[:DIGITS]


def begun(reader: EpisodeReader, infos: Iterable[EpisodeInfo], session: str) -> list[EpisodeInfo]:
    """Return `infos` as `reader` holds them, of whichever session, and the others as of `session`.

    So a recording that is called again goes on where it ended; a scene of which there is only an
    attempt that was cut short is still to be had.
    """
    held = {
        scene: session
        for scene, session in map(split_session, reader.names())
        if not is_cut_short(session)
    }
    return [
        replace(info, session=held.get(episode_name(replace(info, session="")), session))
        for info in infos
    ]
