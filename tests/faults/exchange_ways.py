"""Ways to spoil another tool's file, and to make one that means harm; each is seeded."""

import json
import os
import zipfile
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import zarr

Rng = np.random.Generator
Spoil = Callable[[Path, Rng], None]
"""Spoils the sound file, or folder, at a path; what lies beside it may be pulled in by links."""
SECRET = "secret.txt"
"""beside the file: nothing of it may ever be read"""


def one_of(rng: Rng, options: Any) -> Any:
    return options[int(rng.integers(len(options)))]


def files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    return sorted(file for file in path.rglob("*") if file.is_file())


def chunks(path: Path) -> list[Path]:
    return [file for file in files(path) if not file.name.startswith(".")]


def cut(path: Path, rng: Rng) -> None:
    file = one_of(rng, files(path))
    file.write_bytes(file.read_bytes()[: int(rng.integers(file.stat().st_size))])


def flip_bits(path: Path, rng: Rng) -> None:
    file = one_of(rng, files(path))
    content = bytearray(file.read_bytes())
    for place in rng.integers(len(content), size=int(rng.integers(1, 4))):
        content[place] ^= 1 << int(rng.integers(8))
    file.write_bytes(bytes(content))


def noise(path: Path, rng: Rng) -> None:
    file = one_of(rng, files(path))
    content = bytearray(file.read_bytes())
    start, length = int(rng.integers(len(content))), int(rng.integers(1, 500))
    content[start : start + length] = rng.bytes(length)
    file.write_bytes(bytes(content))


def missing(path: Path, rng: Rng) -> None:
    one_of(rng, files(path)).unlink()


def array_metadata(path: Path, rng: Rng) -> None:
    """What a file says of an array is not what is read here."""
    file = one_of(rng, sorted(path.rglob(".zarray")))
    told = json.loads(file.read_text())
    key, wrong = one_of(rng, METADATA)
    if callable(wrong):
        wrong = wrong(told[key])
    if wrong is ...:
        del told[key]
    else:
        told[key] = wrong
    file.write_text(json.dumps(told))


METADATA: tuple[tuple[str, Any], ...] = (
    *(
        ("dtype", dtype)
        for dtype in (
            "|O",
            "<M8[s]",
            "<U4",
            "|S9",
            "|V8",
            "<c8",
            "<f16",
            [["a", "<f4"]],
            "x",
            7,
            None,
            ...,
        )
    ),
    *(
        ("compressor", codec)
        for codec in (
            {"id": "pickle"},
            {"id": "json2"},
            {"id": "vlen-utf8"},
            {"id": "msgpack2"},
            {"id": "packbits"},
            {"id": "lz4"},
            {"id": ["zlib"]},
            {"id": "moon"},
            {},
            [],
            7,
            ...,
        )
    ),
    *(
        ("filters", filters)
        for filters in ([{"id": "vlen-utf8"}], [{"id": "pickle"}], [{"id": "delta"}], 7)
    ),
    *(
        ("shape", shape)
        for shape in (
            [10**15, 10**15],
            [-1],
            [],
            ["x"],
            [1.5],
            [True],
            None,
            10,
            [10**400],
            lambda told: [10**12, *told[1:]],
            lambda told: [*told, 1],
        )
    ),
    *(
        ("chunks", shape)
        for shape in (
            [0],
            [2**40],
            None,
            lambda told: [2**33, *told[1:]],
            lambda told: [0, *told[1:]],
            lambda told: [-1, *told[1:]],
        )
    ),
    ("order", "K"),
    ("order", None),
    ("fill_value", "moon"),
    ("fill_value", {"a": 1}),
    ("zarr_format", 3),
    ("zarr_format", None),
    ("dimension_separator", "../"),
    ("dimension_separator", 7),
)


def group_metadata(path: Path, rng: Rng) -> None:
    texts = [
        "[" * 100_000,
        "null",
        "[]",
        "7",
        "",
        '{"zarr_format": 3}',
        '{"sheath": 7}',
        "\ufeff{}",
    ]
    names = [".zgroup", ".zattrs", "meta/episode_ends/.zarray"]
    (path / one_of(rng, names)).write_text(one_of(rng, texts))


def ends(path: Path, rng: Rng) -> None:
    root = zarr.open_group(path, mode="r+")
    wrong = [
        np.zeros(2, int),
        np.array([9, 4]),
        np.ones((2, 2)),
        np.array([10**9]),
        np.array([4.5, 10.0]),
        np.array([-4, 10]),
        np.array([2**63, 5], np.uint64),
        np.array([True, False]),
        np.array([np.nan, 10]),
        np.array([3, 3]),
    ]
    root.create_array("meta/episode_ends", data=one_of(rng, wrong), overwrite=True)


def links(path: Path, rng: Rng) -> None:
    """What lies outside is pulled in, or nothing ever comes."""
    chunk = one_of(rng, chunks(path))
    kind = int(rng.integers(6))
    if kind < 4:
        chunk.unlink()
    if kind == 0:
        chunk.symlink_to(path.parent / SECRET)
    elif kind == 1:
        os.mkfifo(chunk)
    elif kind == 2:
        chunk.symlink_to(chunk)
    elif kind == 3:
        chunk.symlink_to("/dev/zero")
    elif kind == 4:
        (path / "data" / "again").symlink_to(path)
    else:
        moved = path.parent / "moved"
        chunk.parent.rename(moved)
        chunk.parent.symlink_to(moved)


def links_among(*patterns: str) -> Spoil:
    """A file of those that a pattern names is a link, a pipe, or a device."""

    def spoil(path: Path, rng: Rng) -> None:
        file = one_of(rng, sorted(each for pattern in patterns for each in path.glob(pattern)))
        if file.is_dir():
            file = file / "link"
        file.unlink(missing_ok=True)
        kind = int(rng.integers(4))
        if kind == 0:
            file.symlink_to(path.parent / SECRET)
        elif kind == 1:
            os.mkfifo(file)
        elif kind == 2:
            file.symlink_to(file)
        else:
            file.symlink_to("/dev/zero")

    return spoil


def chunk_bombs(path: Path, rng: Rng) -> None:
    """A chunk, or a whole array, is far larger than the disk says."""
    chunk = one_of(rng, chunks(path))
    metadata = chunk.parent / ".zarray"
    told = json.loads(metadata.read_text())
    kind = int(rng.integers(4))
    if kind == 0:
        told["compressor"] = {"id": "zlib", "level": 9}
        chunk.write_bytes(zlib.compress(bytes(200 << 20), 9))
    elif kind == 1:
        told["compressor"] = {"id": "zstd", "level": 1}
        chunk.write_bytes(bytes.fromhex("28b52ffde0") + (2**40).to_bytes(8, "little") + bytes(20))
    elif kind == 2:
        told["compressor"] = {"id": "blosc", "cname": "lz4", "clevel": 5, "shuffle": 1}
        size = (2**31 - 1).to_bytes(4, "little")
        chunk.write_bytes(b"\x02\x01\x21\x08" + size + size + bytes(20))
    else:
        root = zarr.open_group(path, mode="r+")
        root.create_array("meta/episode_ends", data=np.array([4, 10**11]), overwrite=True)
        for file in path.glob("data/*/.zarray"):
            told = json.loads(file.read_text())
            told["shape"][0], told["chunks"][0] = 10**11, 10**6
            file.write_text(json.dumps(told))
        return
    metadata.write_text(json.dumps(told))


def zip_members(path: Path, rng: Rng) -> None:
    """Members that are links, lie about their size, or are there twice."""
    kind = int(rng.integers(3))
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        if kind == 0:
            link = zipfile.ZipInfo("data/link/0.0")
            link.external_attr = 0o120777 << 16
            archive.writestr(link, f"../{SECRET}")
        elif kind == 1:
            archive.writestr("data/bomb/.zarray", bytes(300 << 20))
        else:
            archive.writestr("data/../../x/.zarray", "{}")
            archive.writestr("data/\x1b[31m/.zarray", "{}")


FOLDER: Mapping[str, Spoil] = {
    "metadata of an array": array_metadata,
    "metadata of a group": group_metadata,
    "ends of episodes": ends,
    "links and pipes": links,
    "memory bombs": chunk_bombs,
}
ANY: Mapping[str, Spoil] = {
    "cut short": cut,
    "bits flipped": flip_bits,
    "bytes overwritten": noise,
    "files missing": missing,
}
