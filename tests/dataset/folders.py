"""Stores as they were before each episode was an archive, and archives of what is in a folder."""

import shutil
import zipfile
from pathlib import Path

from sheath_manip.dataset.archive import SUFFIX, write_archive
from sheath_manip.dataset.index import INDEX
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.naming import is_episode_name
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.rooted_files import entries, is_folder, kind_of
from sheath_manip.dataset.store import EpisodeStore

MOST_BYTES = 64 << 20
"""of a folder that is made an archive: one that is larger is so to take nobody's memory"""


def as_folders(store: Path) -> None:
    """Unpack every episode of a store, and take away what a store of schema 1 had not."""
    for archive in sorted(store.glob(f"*{SUFFIX}")):
        folder(archive)
    (store / INDEX).unlink(missing_ok=True)
    marker = store / MARKER
    marker.write_text(marker.read_text().replace('"schema": 2', '"schema": 1'))


def repack(store: Path) -> None:
    """Make an archive of every folder of an episode in which there are plain files only."""
    for inside in sorted(store.iterdir()):
        if is_folder(inside) and is_episode_name(inside.name) and _is_plain(inside):
            repacked(inside)


def _is_plain(inside: Path) -> bool:
    found = list(entries(inside))
    names = all(path.isprintable() and "\\" not in path for path, _ in found)
    sizes = sum(at.st_size for _, at in found)
    return names and sizes < MOST_BYTES and not any(kind_of(at) for _, at in found)


def unpacked(store: EpisodeStore, name: str) -> Path:
    """Put the folder of an episode in the place of its archive, and say where it is."""
    return folder(archive_path(store.path, name))


def folder(archive: Path) -> Path:
    """Put the folder of an episode in the place of its archive."""
    inside = archive.with_name(archive.name.removesuffix(SUFFIX))
    with zipfile.ZipFile(archive) as opened:
        opened.extractall(inside)
    archive.unlink()
    return inside


def repacked(inside: Path) -> Path:
    """Put an archive of its plain files in the place of an episode's folder."""
    archive = inside.with_name(f"{inside.name}{SUFFIX}")
    files = sorted(path for path in inside.rglob("*") if path.is_file())
    write_archive(((f.relative_to(inside).as_posix(), f.read_bytes()) for f in files), archive)
    shutil.rmtree(inside)
    return archive
