"""Tasks that stand in no table: of a file, `cart.py:CART`, or of a module, `carts.own:CART`."""

import sys
import traceback
from importlib import import_module, invalidate_caches
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from sheath_manip.exceptions import RegistrationError, UnknownNameError
from sheath_manip.experiments.study import Study
from sheath_manip.task import Task

WANTED = "wanted file.py:TASK, such as examples/own_task.py:CART"


def is_reference(name: str) -> bool:
    """Whether `name` says where a task is found, where others are names in a table."""
    return ":" in name or name.endswith(".py")


def referenced(reference: str) -> Task | Study:
    """Import and return the task, or the study of one, that `reference` names.

    A file is imported as Python runs a script: by its own name, with its folder first among the
    places of modules, so that worker processes find what it defines.

    Raises RegistrationError where the file or the module cannot be imported, or what it names is no
    task, and UnknownNameError where it has nothing of that name.
    """
    place, _, attribute = reference.rpartition(":")
    if not place:
        place, attribute = reference, ""
    module = _of_file(Path(place)) if place.endswith(".py") else _imported(place, place)
    offered = [name for name, each in vars(module).items() if isinstance(each, Task | Study)]
    if not offered and not hasattr(module, attribute):
        raise RegistrationError(f"{place} holds no Task; wanted one in it, as CART = Task(…)")
    if not attribute:
        raise RegistrationError(
            f"{reference} does not say which task of the file; wanted {place}:{offered[0]}"
        )
    if not hasattr(module, attribute):
        raise UnknownNameError(f"task of {place}", attribute, offered, WANTED)
    found = getattr(module, attribute)
    if not isinstance(found, Task | Study):
        raise RegistrationError(
            f"{reference} is of type {type(found).__name__}; wanted a Task, or a Study of one"
        )
    return found


def _of_file(file: Path) -> ModuleType:
    path = file.resolve()
    if not path.is_file():
        raise RegistrationError(f"there is no file {file}; {WANTED}")
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
