"""Where the models of arms lie; nothing is imported for it, and nothing is downloaded."""

import os
from importlib.util import find_spec
from pathlib import Path

from sheath_manip.exceptions import SetupError
from sheath_manip.tasks.robots.arm_file import Source

MENAGERIE = "MENAGERIE_ROOT"
"""the environment variable that names a checkout of mujoco_menagerie"""


def located(model: str, beside: Path, source: Source | None) -> Path:
    """Return the file of `model`: beside the arm's file, in the Menagerie's checkout, in a package.

    Raises SetupError that says what to install.
    """
    folders = [beside]
    if root := os.environ.get(MENAGERIE):
        folders.append(Path(root))
    if source is not None:
        folders += _folders(source)
    for folder in folders:
        if (folder / model).is_file():
            return folder / model
    looked = ", ".join(str(folder) for folder in folders)
    ways = [] if source is None else [f"install {source.package} with `{source.install}`"]
    if source is None or source.menagerie:
        ways.append(f"set {MENAGERIE} to a checkout of mujoco_menagerie that has it")
    raise SetupError(f"no model {model} in {looked}; {', or '.join(ways)}")


def _folders(source: Source) -> list[Path]:
    """The folder in the package, wherever that is installed."""
    name, _, inside = source.folder.partition("/")
    # Only looked up: its own code may want other versions of what is here.
    found = find_spec(name)
    places = () if found is None else found.submodule_search_locations or ()
    return [Path(place) / inside for place in places]
