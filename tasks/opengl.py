"""OpenGL is tried once, before a task imports the simulator: where none works, it has none.

The simulator cannot be imported with an OpenGL that does not work, and a task without a camera
wants none. Who wants a picture then is told why there is none, in the words of `sheath doctor`.
"""

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec

from sheath_manip.cli.gl import gl_failure, gl_in_force, gl_problem
from sheath_manip.exceptions import SetupError

BACKEND = gl_in_force()


def _tried() -> str | None:
    """Why there is no OpenGL; None where it works, or there is no simulator."""
    problem = gl_problem(BACKEND)
    if find_spec("dm_control") is None:
        return problem
    if problem is None:
        try:
            _import_with_it()
        except Exception as error:
            problem = gl_failure(BACKEND, error)
    if problem is not None:
        _import_without()
    return problem


def _import_with_it() -> None:
    with warnings.catch_warnings():
        # GLFW warns of what is told here in one line.
        warnings.simplefilter("ignore")
        # EGL opens its display here, so that a driver that is missing shows.
        import_module("dm_control._render")
        if BACKEND == "glfw" and not import_module("glfw").init():
            raise RuntimeError("there is no display")


def _import_without() -> None:
    """Import the simulator, which takes its OpenGL at once, and leave the setting to others."""
    before = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = "off"
    try:
        for name in ("mujoco", "dm_control._render"):
            import_module(name)
    finally:
        del os.environ["MUJOCO_GL"]
        if before is not None:
            os.environ["MUJOCO_GL"] = before


PROBLEM = _tried()
"""why there is no OpenGL, with the cure; None where there is"""


def require_opengl() -> None:
    """Raise SetupError, one line with the cure, where there is no OpenGL."""
    if PROBLEM is not None:
        raise SetupError(PROBLEM)


@contextmanager
def first_picture() -> Iterator[None]:
    """Raise SetupError, one line with the cure, where the first picture cannot be rendered."""
    require_opengl()
    try:
        yield
    except Exception as error:
        raise SetupError(gl_failure(BACKEND, error)) from error
