import ctypes

import pytest

from sheath_manip.cli import gl
from sheath_manip.exceptions import SetupError


@pytest.fixture(autouse=True)
def _fresh_cache():
    gl._load_gl.cache_clear()
    yield
    gl._load_gl.cache_clear()


def test_a_back_end_that_breaks_gives_its_last_line():
    # MuJoCo refuses the name before it looks for a library.
    result = gl.render_time_ms("vulkan")
    assert isinstance(result, str)
    assert "vulkan" in result


@pytest.mark.parametrize("backend", ["egl", "osmesa", "glfw"])
def test_require_gl_names_the_library_and_its_package(monkeypatch, backend: str):
    monkeypatch.setenv("MUJOCO_GL", backend)
    monkeypatch.setattr(ctypes, "CDLL", _no_library)
    with pytest.raises(SetupError) as caught:
        gl.require_gl()
    message = str(caught.value)
    assert "\n" not in message
    assert gl.GL_LIBRARIES[backend][0][0] in message
    assert gl.GL_CURES[backend] in message


def _no_library(name: str):
    raise OSError(f"{name}: cannot open shared object file")


def test_require_gl_takes_any_name_of_a_library(monkeypatch):
    def load(name: str):
        if name not in ("libEGL.so", "libGL.so.1"):
            _no_library(name)

    monkeypatch.setenv("MUJOCO_GL", "egl")
    monkeypatch.setattr(ctypes, "CDLL", load)
    gl.require_gl()


def test_require_gl_looks_once(monkeypatch):
    asked = []
    monkeypatch.setenv("MUJOCO_GL", "egl")
    monkeypatch.setattr(ctypes, "CDLL", asked.append)
    gl.require_gl()
    gl.require_gl()
    assert len(asked) == 2


def test_require_gl_refuses_an_unknown_back_end(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "off")
    with pytest.raises(SetupError, match="egl, osmesa, glfw"):
        gl.require_gl()
