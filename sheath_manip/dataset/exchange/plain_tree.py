"""The files of a folder or a zip archive by their paths in it: plain ones, and none elsewhere."""

import io
import json
import os
import stat
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

from sheath_manip.dataset.exchange.limits import MOST_ENTRIES, Limits
from sheath_manip.exceptions import StoreError
from sheath_manip.files.plain_files import open_plain, read_plain

MOST_DEEP = 8
"""folders in each other"""
JSON_TIMES_LARGER = 30
"""what the bytes of a JSON file take in memory at most, once they are objects"""


class PlainTree(Protocol):
    """Files, by their paths with slashes."""

    @property
    def sizes(self) -> Mapping[str, int]:
        """In bytes, by path."""
        ...

    def read(self, file: str) -> bytes:
        """Return what is in a file; raises OSError, and ValueError for a broken archive."""
        ...


class FolderTree:
    """The files of a folder; StoreError where anything in it is neither folder nor plain file."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.sizes = _sizes(root)

    def read(self, file: str) -> bytes:
        """Return what is in a file; raises OSError, also where it has grown or is a link now."""
        return read_plain(self.root / file, self.sizes[file], follow=False)

    def open(self, file: str) -> io.BufferedReader:
        """Open a file to read parts of it; raises OSError where it is no plain file any more."""
        if file not in self.sizes:
            raise StoreError(f"there is no {file}")
        return open_plain(self.root / file, follow=False)


class ZipTree:
    """The members of a zip archive, which stays open; StoreError where one is a link."""

    def __init__(self, path: Path) -> None:
        open_plain(path).close()
        self._archive = zipfile.ZipFile(path)
        members = self._archive.infolist()
        links = [each for each in members if stat.S_ISLNK(each.external_attr >> 16)]
        if links or len(members) > MOST_ENTRIES:
            raise StoreError(
                f"{path} has {len(members)} members, {len(links)} of them links; wanted at most "
                f"{MOST_ENTRIES} plain files"
            )
        self._members = {each.filename: each for each in members if not each.is_dir()}
        self.sizes = {name: each.file_size for name, each in self._members.items()}

    def read(self, file: str) -> bytes:
        """Return what is in a member; raises zipfile.BadZipFile where its checksum is another."""
        # No more than it declares is ever unpacked.
        return self._archive.read(self._members[file])


def read_json(tree: PlainTree, file: str, limits: Limits) -> Any:
    """Return what the JSON file says; raises StoreError where there is none, or it is too large."""
    return json.loads(read_text(tree, file, limits))


def read_text(tree: PlainTree, file: str, limits: Limits) -> bytes:
    """Return a text that is made of JSON; raises StoreError as `read_json`."""
    if file not in tree.sizes:
        raise StoreError(f"there is no {file}")
    limits.require_memory(file, JSON_TIMES_LARGER * tree.sizes[file])
    return tree.read(file)


def _sizes(root: Path) -> dict[str, int]:
    sizes: dict[str, int] = {}
    waiting = [("", 0)]
    while waiting:
        folder, depth = waiting.pop()
        with os.scandir(root / folder) as entries:
            for entry in entries:
                path, status = f"{folder}{entry.name}", entry.stat(follow_symlinks=False)
                if stat.S_ISREG(status.st_mode):
                    sizes[path] = status.st_size
                elif stat.S_ISDIR(status.st_mode) and depth < MOST_DEEP:
                    waiting.append((f"{path}/", depth + 1))
                else:
                    raise StoreError(
                        f"{path} of {root} is a link, a device or nested too deep; wanted plain "
                        "files and folders only: copy it with `cp -rL`, if you know where it leads"
                    )
                if len(sizes) + len(waiting) > MOST_ENTRIES:
                    raise StoreError(f"{root} has more than {MOST_ENTRIES} files; split it")
    return sizes
