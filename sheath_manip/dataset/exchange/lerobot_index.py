"""The index of a LeRobot data set: which rows of which file, and which frames, are an episode.

Format 2 has a table and a film for each episode, listed in `meta/episodes.jsonl`; format 3 joins
them, and lists in tables below `meta/episodes/` where each begins. Paths are templates that the
data set itself gives: they are filled in here by hand, since `str.format` would do what a file
says, and must name files that are there.
"""

import json
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.dataset.exchange.parquet import Parquet
from sheath_manip.dataset.exchange.plain_tree import FolderTree, read_json, read_text
from sheath_manip.dataset.fields import MOST_STEPS, number, rows_of, whole, word
from sheath_manip.exceptions import StoreError

INFO = "meta/info.json"
VERSIONS = ("v2.0", "v2.1", "v3.0")
KEPT_TO_ITSELF = ("timestamp", "frame_index", "episode_index", "index", "task_index")
"""features by which LeRobot finds its way, and that nobody learns from"""
_FIELD = re.compile(r"\{(\w+)(?::0?(\d{1,2})d)?\}")
_NUMBER = whole(0, MOST_STEPS)
_PIXELS = whole(1, 2**16)


@dataclass(frozen=True)
class Feature:
    """What a data set says of one of its columns."""

    dtype: str
    """`video`, `image`, `string`, or a number's"""
    shape: tuple[int, ...]
    """of a row; of images (h, w)"""
    names: tuple[str, ...] = ()
    """of the entries of a vector; empty where they have none"""

    @property
    def is_image(self) -> bool:
        """Whether its rows are images."""
        return self.dtype in ("video", "image")


@dataclass(frozen=True)
class Clip:
    """The part of a film that shows an episode."""

    file: str
    from_s: float


@dataclass(frozen=True)
class Entry:
    """Where an episode lies."""

    number: int
    length: int
    words: str
    """what was to be done"""
    table: str
    first_row: int
    clips: Mapping[str, Clip]
    """by feature"""


@dataclass(frozen=True)
class Index:
    """What a data set says of itself."""

    rate_hz: float
    features: Mapping[str, Feature]
    entries: tuple[Entry, ...]


def read_index(tree: FolderTree, limits: Limits) -> Index:
    """Read it; raises StoreError or ValueError where it is of another kind than is read here."""
    info = read_json(tree, INFO, limits)
    version = info.get("codebase_version") if isinstance(info, dict) else None
    if version not in VERSIONS:
        raise StoreError(
            f"it is of LeRobot's format {version!r:.20}; wanted {', '.join(VERSIONS)}: LeRobot "
            "converts those of before"
        )
    features = {word(name): _feature(told) for name, told in dict(info["features"]).items()}
    films = [name for name, feature in features.items() if feature.dtype == "video"]
    read = _joined if version.startswith("v3") else _apart
    entries = tuple(read(tree, info, films, limits))
    if (told := info.get("total_episodes", len(entries))) != len(entries):
        raise StoreError(f"it tells of {told!r:.20} episodes, its index of {len(entries)}")
    for entry in entries:
        files = (entry.table, *(clip.file for clip in entry.clips.values()))
        if lost := [file for file in files if file not in tree.sizes]:
            raise StoreError(f"episode {entry.number} is in {lost[0]!r:.200}, and that is not here")
    return Index(number(info["fps"]), features, entries)


def _feature(told: Any) -> Feature:
    dtype, shape = word(told["dtype"]), rows_of(_NUMBER, 8)(told["shape"])
    names = told.get("names")
    if isinstance(names, dict) and len(names) == 1:
        # As {"motors": [...]}, of format 2.
        (names,) = names.values()
    if dtype in ("video", "image"):
        channels_first = isinstance(names, list) and names[:1] in (["channels"], ["channel"])
        height, width = shape[1:] if channels_first else shape[:2]
        return Feature(dtype, (_PIXELS(height), _PIXELS(width)))
    named = isinstance(names, list) and len(shape) == 1 and len(names) == shape[0]
    return Feature(dtype, shape, tuple(map(word, names)) if named else ())


def _apart(tree: FolderTree, info: Any, films: list[str], limits: Limits) -> Iterator[Entry]:
    """Yield the entries of format 2."""
    for line in read_text(tree, "meta/episodes.jsonl", limits).splitlines():
        limits.require_time()
        told = json.loads(line)
        episode = _NUMBER(told["episode_index"])
        places = {"episode_index": episode, "episode_chunk": episode // _size(info)}
        yield Entry(
            episode,
            _length(told["length"]),
            _words(told.get("tasks")),
            _filled(info["data_path"], places),
            0,
            {
                film: Clip(_filled(info["video_path"], {**places, "video_key": film}), 0.0)
                for film in films
            },
        )


def _joined(tree: FolderTree, info: Any, films: list[str], limits: Limits) -> Iterator[Entry]:
    """Yield the entries of format 3."""
    rows = defaultdict[str, int](int)
    for file in sorted(tree.sizes):
        if not (file.startswith("meta/episodes/") and file.endswith(".parquet")):
            continue
        table = Parquet(tree, file, limits)
        columns = ["episode_index", "length", "tasks", *_places("data")]
        for film in films:
            columns += [*_places(f"videos/{film}"), f"videos/{film}/from_timestamp"]
        columns = [name for name in columns if name != "tasks" or name in table.columns]
        values = (table.rows(name, 0, table.length) for name in columns)
        for row in zip(*values, strict=True):
            limits.require_time()
            told = dict(zip(columns, row, strict=True))
            length = _length(told["length"])
            data = _filled(info["data_path"], _at(told, "data"))
            yield Entry(
                _NUMBER(told["episode_index"]),
                length,
                _words(told.get("tasks")),
                data,
                rows[data],
                {
                    film: Clip(
                        _filled(
                            info["video_path"],
                            {**_at(told, f"videos/{film}"), "video_key": film},
                        ),
                        number(told[f"videos/{film}/from_timestamp"]),
                    )
                    for film in films
                },
            )
            rows[data] += length


def _places(what: str) -> tuple[str, str]:
    return f"{what}/chunk_index", f"{what}/file_index"


def _at(told: Mapping[str, Any], what: str) -> dict[str, Any]:
    return {name.rpartition("/")[2]: _NUMBER(told[name]) for name in _places(what)}


def _filled(template: Any, values: Mapping[str, Any]) -> str:
    """Return the path that a template gives for an episode."""

    def put(match: re.Match[str]) -> str:
        if match[1] not in values:
            raise StoreError(f"a path is {template!r:.100}; wanted fields of {', '.join(values)}")
        value = values[match[1]]
        return f"{value:0{int(match[2] or 0)}d}" if isinstance(value, int) else str(value)

    return _FIELD.sub(put, word(template))


def _size(info: Any) -> int:
    return whole(1, MOST_STEPS)(info.get("chunks_size", 1000))


def _length(told: Any) -> int:
    return whole(1, MOST_STEPS)(told)


def _words(told: Any) -> str:
    return "; ".join(rows_of(word, 256)(told or []))
