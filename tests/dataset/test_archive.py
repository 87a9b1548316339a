"""An episode is one file that zarr opens, and a file that is none harms nobody."""

import io
import os
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from zarr.storage import ZipStore

from sheath_manip.dataset.archive import Archive, BrokenArchiveError, give_name, write_archive
from sheath_manip.dataset.check import check
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.rooted_files import OddFileError
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode
from tests.dataset.tiny_episodes import INFO, tiny

FILES = [("zarr.json", b"{}"), ("x/c.0", b"\0" * 100), ("x/zarr.json", b"[]")]


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    write_archive(iter(FILES), tmp_path / "a.zip")
    return tmp_path / "a.zip"


def test_an_episode_is_one_file_with_every_array_under_its_name(
    store: EpisodeStore, episode: Episode
) -> None:
    name = store.append(episode)
    assert store.files(name).keys() == set(
        zipfile.ZipFile(archive_path(store.path, name)).namelist()
    )
    group = zarr.open_group(ZipStore(archive_path(store.path, name), mode="r"), mode="r")
    for spec in layout(store.header(name)):
        array = group[spec.path]
        assert isinstance(array, zarr.Array)
        assert np.asarray(array[...]).tobytes() == store.array(name, spec).tobytes()


def test_the_same_files_are_the_same_archive(archive: Path) -> None:
    again = archive.with_name("again.zip")
    write_archive(iter(FILES), again)
    assert again.read_bytes() == archive.read_bytes()
    assert Archive(archive).files() == {name: len(content) for name, content in FILES}
    assert [Archive(archive).content(name, 1000) for name, _ in FILES] == [c for _, c in FILES]


def test_it_takes_no_name_from_another(archive: Path) -> None:
    other = archive.with_name("b.zip")
    write_archive([("zarr.json", b"other")], other)
    with pytest.raises(FileExistsError):
        give_name(archive, other)
    assert Archive(other).content("zarr.json", 9) == b"other"
    give_name(archive, archive.with_name("c.zip"))
    assert not archive.exists()


def test_what_is_asked_for_must_be_there_and_not_too_large(archive: Path) -> None:
    with pytest.raises(FileNotFoundError):
        Archive(archive).content("y", 10)
    with pytest.raises(OddFileError, match="100 bytes, wanted at most 99"):
        Archive(archive).content("x/c.0", 99)
    link = archive.with_name("link.zip")
    link.symlink_to(archive)
    fifo = archive.with_name("fifo.zip")
    os.mkfifo(fifo)
    for odd in (link, fifo):
        with pytest.raises(OddFileError):
            Archive(odd).files()


def test_one_that_was_replaced_is_read_anew(archive: Path) -> None:
    opened = Archive(archive)
    assert opened.content("zarr.json", 9) == b"{}"
    archive.unlink()
    write_archive([("zarr.json", b"new")], archive)
    assert opened.content("zarr.json", 9) == b"new"


def zipped(*entries: tuple[str, bytes], **options: Any) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", **options) as opened:
        for name, content in entries:
            opened.writestr(name, content)
    return made.getvalue()


def large_list(content: bytes) -> bytes:
    """The list of files claims to take more bytes than there are."""
    return content[:-10] + struct.pack("<L", 0xFFFFFF) + content[-6:]


HOSTILE: dict[str, Callable[[bytes], bytes]] = {
    "nothing": lambda _: b"",
    "noise": lambda _: b"PK\5\6" + b"\xff" * 18,
    "cut off": lambda content: content[:-1],
    "more after it": lambda content: content + b"more",
    "a large list": large_list,
    "compressed": lambda _: zipped(*FILES, compression=zipfile.ZIP_DEFLATED),
    "outside": lambda _: zipped(("../x", b"")),
    "absolute": lambda _: zipped(("/x", b"")),
    "a folder": lambda _: zipped(("x/", b"")),
    "a list elsewhere": lambda content: content[:-6] + b"\xff\xff\xff\x7f" + content[-2:],
}


@pytest.mark.parametrize("what", HOSTILE)
def test_what_is_not_written_here_is_refused(archive: Path, what: str) -> None:
    archive.write_bytes(HOSTILE[what](archive.read_bytes()))
    with pytest.raises(BrokenArchiveError):
        Archive(archive).files()


def test_any_bit_is_told_of_or_harmless(store: EpisodeStore) -> None:
    name = store.append(tiny(INFO))
    before, path = store.recorded(name), archive_path(store.path, name)
    content, rng = path.read_bytes(), np.random.default_rng(0)
    for _ in range(60):
        spoilt = bytearray(content)
        spoilt[int(rng.integers(len(content)))] ^= 1 << int(rng.integers(8))
        path.write_bytes(bytes(spoilt))
        try:
            read = EpisodeStore(store.path).recorded(name)
        except StoreError:
            assert any(fault.damaging for fault in check(store))
            continue
        for key, array in before.arrays.items():
            assert np.asarray(read.arrays[key]).tobytes() == np.asarray(array).tobytes()


def test_a_checksum_that_only_others_look_at_is_checked(archive: Path) -> None:
    content = bytearray(archive.read_bytes())
    content[content.index(b"PK\1\2") + 16] ^= 1
    archive.write_bytes(bytes(content))
    assert Archive(archive).content("zarr.json", 9) == b"{}"
    with pytest.raises(BrokenArchiveError, match=r"zarr\.json"):
        Archive(archive).require_intact()
