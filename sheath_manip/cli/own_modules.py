"""Files and modules of somebody else that the command line names."""

import sys
import traceback
from importlib import import_module, invalidate_caches
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from sheath_manip.exceptions import RegistrationError


def module_at(place: str, wanted: str) -> ModuleType:
    """Import and return the module of a file, `cart.py`, or of a name, `carts.own`.

    A file is imported as Python runs a script: by its own name, with its folder first among the
    places of modules, so that worker processes find what it defines.

    Raises RegistrationError where it cannot be imported; `wanted` says what would have worked.
    """
    return _of_file(Path(place), wanted) if place.endswith(".py") else _imported(place, place)


def _of_file(file: Path, wanted: str) -> ModuleType:
    path = file.resolve()
    if not path.is_file():
        raise RegistrationError(f"there is no file {file}; {wanted}")
    if not path.stem.isidentifier():
        raise RegistrationError(
            f"{file} cannot be imported by its name; wanted one of letters, digits and _"
        )
    folder = str(path.parent)
    if folder not in sys.path:
        # Worker processes take this over: what they are sent names its classes by module.
        sys.path.insert(0, folder)
    invalidate_caches()
    module = _imported(path.stem, str(file))
    if Path(getattr(module, "__file__", None) or "").resolve() != path:
        raise RegistrationError(
            f"{file} has the name of another module ({module.__file__ or path.stem}); rename it"
        )
    return module


def _imported(module: str, shown: str) -> ModuleType:
    # Before whatever opens a GL context: loaded after one, triton ends the process
    # (`sheath_manip.tasks` has the whole story).
    for name in ("torch", "triton"):
        if find_spec(name):
            import_module(name)
    try:
        return import_module(module)
    except (Exception, SystemExit) as error:
        raise RegistrationError(
            f"{shown} cannot be imported ({type(error).__name__}{_line_of(error, shown)}: {error})"
        ) from error


def _line_of(error: BaseException, file: str) -> str:
    """Return the last line of `file` that was run, as a syntax error says it by itself."""
    here = Path(file).resolve()
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename).resolve() == here
    ]
    return f" in line {lines[-1]}" if lines else ""
