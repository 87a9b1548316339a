"""Where the files lie that tasks and robots are built from, in a checkout as in a wheel."""

from importlib.resources import files
from pathlib import Path


def assets_of(name: str) -> Path:
    """Return the folder of MJCF files and textures called `name`, such as `arm`."""
    return Path(str(files("sheath_manip"))) / "assets" / name
