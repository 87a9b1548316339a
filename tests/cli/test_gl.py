import ctypes

import pytest

from sheath_manip.cli import gl


def test_a_back_end_that_breaks_gives_its_last_line():
    # MuJoCo refuses the name before it looks for a library.
    result = gl.render_time_ms("vulkan")
    assert isinstance(result, str)
    assert "vulkan" in result


@pytest.mark.parametrize("backend", ["egl", "osmesa", "glfw"])
def test_the_library_that_is_missing_is_named_with_its_package(monkeypatch, backend: str):
    monkeypatch.setattr(ctypes, "CDLL", _no_library)
    problem = gl.gl_problem(backend)
    assert problem is not None
    assert "\n" not in problem
    assert gl.GL_LIBRARIES[backend][0][0] in problem
    assert gl.GL_CURES[backend] in problem


def _no_library(name: str):
    raise OSError(f"{name}: cannot open shared object file")


def test_any_name_of_a_library_will_do(monkeypatch):
    def load(name: str):
        if name not in ("libEGL.so", "libGL.so.1"):
            _no_library(name)

    monkeypatch.setattr(ctypes, "CDLL", load)
    assert gl.gl_problem("egl") is None


def test_a_back_end_that_is_off_or_unknown_is_told():
    assert "egl, osmesa, glfw" in str(gl.gl_problem("vulkan"))
    assert "unset MUJOCO_GL" in str(gl.gl_problem("off"))


@pytest.mark.parametrize(
    ("said", "told"), [("", "ValueError"), ("No driver.\nAt all.", "No driver")]
)
def test_a_driver_that_fails_is_told_in_one_line_with_the_cure(said: str, told: str):
    line = gl.gl_failure("egl", ValueError(said))
    assert "\n" not in line
    assert f"MUJOCO_GL=egl does not work here ({told}); cure: apt-get" in line
