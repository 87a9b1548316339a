"""An episode's group as a folder of many files: how it was recorded before it was an archive."""

import stat
from collections.abc import Mapping
from pathlib import Path

from sheath_manip.dataset.rooted_files import entries, kind_of, read_inside


class Folder:
    """The files in the folder of an episode."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def files(self) -> Mapping[str, int]:
        """The size in bytes of each plain file in it, by its path; raises OSError."""
        found = sorted(entries(self.path))
        return {path: at.st_size for path, at in found if stat.S_ISREG(at.st_mode)}

    def odd_files(self) -> Mapping[str, str]:
        """What is neither file nor folder in it, by its path, such as `a link`; raises OSError."""
        found = sorted(entries(self.path))
        return {path: kind for path, at in found if (kind := kind_of(at))}

    def content(self, file: str, most_bytes: int) -> bytes:
        """Return what is in a file.

        Raises FileNotFoundError where there is none, OddFileError where it is no plain one, lies
        behind a link or has more bytes, and OSError.
        """
        return read_inside(self.path.parent, f"{self.path.name}/{file}", most_bytes)

    def require_intact(self) -> None:
        """Do nothing: each file is asked for by itself."""
