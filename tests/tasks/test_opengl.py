"""Without an OpenGL that works tasks with a camera say so in one line, and others run."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.waiting import DEADLINE_S

# Both in one process: to import torch and the simulator takes seconds.
PLAY_AND_COLLECT = """
import sys
from sheath_manip.command import load_catalog, main
environment = load_catalog().tasks["platformer"].make()
environment.reset(0)
environment.close()
sys.exit(main(["collect", "driving", "--store", sys.argv[1], "--episodes", "1"]))
"""
NO_DRIVER = {"MUJOCO_GL": "egl", "__EGL_VENDOR_LIBRARY_FILENAMES": "/none.json"}


def called(store: Path, setting: dict[str, str]) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    environment.pop("PYOPENGL_PLATFORM", None)
    return subprocess.run(
        [sys.executable, "-c", PLAY_AND_COLLECT, store],
        env=environment | setting,
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
        check=False,
    )


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        (NO_DRIVER, "MUJOCO_GL=egl does not work here"),
        *(
            pytest.param({"MUJOCO_GL": name}, told, marks=pytest.mark.soak)
            for name, told in {
                "glfw": "does not work here (there is no display)",
                "Off": "MUJOCO_GL=off turns rendering off",
                "vulkan": "it is 'vulkan'",
            }.items()
        ),
    ],
)
def test_what_does_not_work_is_one_line(tmp_path, setting, told) -> None:
    done = called(tmp_path / "store", setting)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("sheath: ")
    assert done.stderr.count("\n") == 1
    assert told in done.stderr
    assert not (tmp_path / "store").exists()


@pytest.mark.soak
@pytest.mark.parametrize("name", ["EGL", " egl", ""])
def test_capitals_blanks_and_an_empty_setting_are_understood(tmp_path, name) -> None:
    done = called(tmp_path / "store", {"MUJOCO_GL": name})
    assert (done.returncode, done.stderr) == (0, "")
