"""Which commits a run was made by: one that is resumed after a change is of more than one."""

import json
from pathlib import Path

from sheath_manip.experiments.summary import git_revision
from sheath_manip.files.json_files import write_json


def note_revision(runs: Path) -> str | None:
    """Note the commit that runs in `runs`, after those that ran there before; return all of them.

    In words, such as `1a2b3c4, then 5d6e7f8`; None without git.
    """
    path, now = runs / "revisions.json", git_revision()
    held = [str(each) for each in json.loads(path.read_text())["git"]] if path.exists() else []
    if now is not None and now not in held[-1:]:
        held.append(now)
        write_json(path, {"git": held})
    return ", then ".join(held) or None
