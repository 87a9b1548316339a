"""Stores as they were before each episode was an archive, and archives of what is in a folder."""

import shutil
import zipfile
from pathlib import Path

from sheath_manip.dataset.archive import SUFFIX, write_archive
from sheath_manip.dataset.index import INDEX
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.store import EpisodeStore


def as_folders(store: Path) -> None:
    """Unpack every episode of a store, and take away what a store of schema 1 had not."""
    for archive in sorted(store.glob(f"*{SUFFIX}")):
        folder(archive)
    (store / INDEX).unlink(missing_ok=True)
    marker = store / MARKER
    marker.write_text(marker.read_text().replace('"schema": 2', '"schema": 1'))


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
