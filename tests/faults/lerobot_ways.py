"""Ways to spoil a LeRobot data set, and to make it read what it must not; each is seeded."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import av
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tests.faults.exchange_ways import SECRET, Rng, Spoil, links_among, one_of

TEMPLATES = (
    f"../{SECRET}",
    f"/{SECRET}",
    "{episode_chunk.__class__}",
    "{0}",
    "{episode_index:999999999d}",
    "{video_key:>99999999}",
    "{moon}",
    "",
    7,
    None,
)
WRONG: Mapping[str, tuple[Any, ...]] = {
    "data_path": TEMPLATES,
    "video_path": TEMPLATES,
    "fps": (0, -1, "x", 1e300, float("nan"), float("inf"), None, [10], 10**400),
    "chunks_size": (0, -1, "x", 10**30),
    "codebase_version": ("v1.6", "v9", 3, None, ["v3.0"]),
    "features": (None, [], 7, {}, {"action": None}, {"action": {"dtype": "float32"}}),
}
FEATURE: Mapping[str, tuple[Any, ...]] = {
    "dtype": ("video", "image", "string", "float32", "moon", None, 7),
    "shape": ([10**9], [10**9, 10**9, 3], [-1], [], [1.5], "x", None, [64, 64]),
    "names": (7, "x", [1, 2, 3], {"a": [1]}, ["../x", "a,b", "\x1b[2J"], ["x"] * 10**5),
}
ROW: Mapping[str, tuple[Any, ...]] = {
    "length": (0, -1, 10**9, 2**63 - 1, 3, 5),
    "episode_index": (-1, 7, 10**12, 2),
    "tasks": (7, [7], ["x" * 10**4], [["x"]]),
    "data/chunk_index": (-1, 7, 10**12),
    f"videos/{'observation.images.film'}/from_timestamp": (-1.0, 1e300, float("nan"), 99.0),
}


def index(path: Path, rng: Rng) -> None:
    """What the set says of itself is not what is read here."""
    file = path / "meta" / "info.json"
    told = json.loads(file.read_text())
    if rng.random() < 0.5:
        key = one_of(rng, list(WRONG))
        told[key] = one_of(rng, WRONG[key])
    else:
        feature, key = (
            told["features"][one_of(rng, list(told["features"]))],
            one_of(rng, list(FEATURE)),
        )
        feature[key] = one_of(rng, FEATURE[key])
    file.write_text(json.dumps(told))


def episodes(path: Path, rng: Rng) -> None:
    """What it says of an episode is none."""
    lines = path / "meta" / "episodes.jsonl"
    if lines.exists():
        told = [json.loads(line) for line in lines.read_text().splitlines()]
        key = one_of(rng, [key for key in ROW if key in told[0]])
        one_of(rng, told)[key] = one_of(rng, ROW[key])
        texts = ["[" * 10**5, "null", "", "7", "{}"]
        text = "\n".join(map(json.dumps, told)) if rng.random() < 0.8 else one_of(rng, texts)
        lines.write_text(text)
        return
    (file,) = path.glob("meta/episodes/*/*.parquet")
    table = pq.read_table(file)
    key = one_of(rng, [key for key in ROW if key in table.column_names and key != "tasks"])
    values = table.column(key).to_pylist()
    values[int(rng.integers(len(values)))] = one_of(rng, (*ROW[key], None))
    _replace(file, table, key, values)


def tables(path: Path, rng: Rng) -> None:
    """A column is another, is gone, or leads elsewhere."""
    file = one_of(rng, sorted(path.glob("data/*/*.parquet")))
    table = pq.read_table(file)
    rows = table.num_rows
    key = one_of(rng, ["action", "observation.state", "observation.images.small", "frame_index"])
    paths = (f"../{SECRET}", f"/{SECRET}", "meta/info.json", "x", "")
    values = one_of(
        rng,
        [
            None,
            [[1.0, 2.0, 3.0]] * (rows - 1) + [[1.0]],
            [None] * rows,
            ["x"] * rows,
            [[[1.0]]] * rows,
            [float("nan")] * rows,
            [b"\x89PNG\r\n\x1a\n"] * rows,
            [{"bytes": b"\xff\xd8\xff", "path": None}] * rows,
            [{"bytes": None, "path": one_of(rng, paths)}] * rows,
            [{"path": 7}] * rows,
        ],
    )
    if values is None:
        pq.write_table(table.drop_columns([key]), file)
    else:
        _replace(file, table, key, values)


def films(path: Path, rng: Rng) -> None:
    """A film is none, is another, or names what FFmpeg would read."""
    file = one_of(rng, sorted(path.glob("videos/**/*.mp4")))
    secret = path.parent / SECRET
    kind = int(rng.integers(5))
    if kind == 0:
        file.write_text(f"#EXTM3U\n#EXTINF:1,\n{secret.as_uri()}\n#EXT-X-ENDLIST\n")
    elif kind == 1:
        file.write_text(f"ffconcat version 1.0\nfile '{secret}'\n")
    elif kind == 2:
        _film(file, *one_of(rng, [("mjpeg", 64, 64), ("mpeg4", 1024, 64), ("mpeg4", 64, 64)]))
    elif kind == 3:
        content = bytearray(file.read_bytes())
        # The sizes that the film tells of itself, twice.
        for name, at in ((b"tkhd", 80), (b"av01", 28)):
            place = content.find(name) + at
            content[place : place + 4] = bytes(map(int, rng.integers(0, 256, 4)))
        file.write_bytes(bytes(content))
    else:
        file.write_bytes(rng.bytes(5000))


def bombs(path: Path, rng: Rng) -> None:
    """A column, or an image, is far larger than the disk says."""
    file = one_of(rng, sorted(path.glob("data/*/*.parquet")))
    table = pq.read_table(file)
    if rng.random() < 0.5:
        longest = [[0.0] * 3_000_000, *[[0.0]] * (table.num_rows - 1)]
        _replace(file, table, "action", longest)
    else:
        # The head of a PNG of 60,000 by 60,000 pixels, and nothing else.
        head = (
            b"\x89PNG\r\n\x1a\n"
            + b"\x00\x00\x00\rIHDR"
            + 2 * b"\x00\x00\xea\x60"
            + b"\x08\x02\x00\x00\x00"
        )
        image = {"bytes": head + bytes(4), "path": None}
        _replace(file, table, "observation.images.small", [image] * table.num_rows)


def _replace(file: Path, table: pa.Table, key: str, values: list[Any]) -> None:
    column = pa.array(values)
    pq.write_table(table.set_column(table.column_names.index(key), key, column), file)


def _film(file: Path, codec: str, height: int, width: int) -> None:
    with av.open(str(file), "w", format="mp4") as container:
        stream: Any = container.add_stream(codec, rate=10, width=width, height=height)
        stream.pix_fmt = "yuvj420p" if codec == "mjpeg" else "yuv420p"
        for _ in range(20):
            frame = av.VideoFrame.from_ndarray(np.zeros((height, width, 3), np.uint8))
            container.mux(stream.encode(frame))
        container.mux(stream.encode())


LEROBOT: Mapping[str, Spoil] = {
    "what it says of itself": index,
    "what it says of an episode": episodes,
    "columns of a table": tables,
    "films": films,
    "memory bombs": bombs,
    "links and pipes": links_among("**/*.parquet", "**/*.mp4", "meta/*"),
}
