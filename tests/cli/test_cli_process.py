"""The installed command as a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.waiting import DEADLINE_S

SHEATH = [str(Path(sys.executable).parent / "sheath")]
SCRIPT = [sys.executable, "-m", "tasks.driving"]


def _call(command: list[str], *argv: object, **environment: str):
    return subprocess.run(
        [*command, *map(str, argv)],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
        check=False,
    )


def _complaint(done) -> str:
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("sheath: ")
    assert done.stderr.count("\n") == 1
    return done.stderr


def test_help_names_every_verb():
    done = _call(SHEATH, "--help")
    assert done.returncode == 0
    assert done.stderr == ""
    verbs = "tasks collect train run evaluate experiment replay data dashboard doctor"
    assert all(verb in done.stdout for verb in verbs.split())


def test_unknown_task_names_the_known_ones(tmp_path):
    done = _call(SHEATH, "collect", "moon", "--store", tmp_path / "store")
    assert _complaint(done) == (
        "sheath: unknown task 'moon'; known: driving, gauze-cutting, grasp-clutter, platformer; "
        "a task of your own is given as file.py:TASK: docs/own/task.md\n"
    )


def test_data_list_of_no_store(tmp_path):
    assert "wanted an episode store" in _complaint(_call(SHEATH, "data", "list", tmp_path))


def test_rendering_that_is_off(tmp_path):
    done = _call(SHEATH, "collect", "driving", "--store", tmp_path / "store", MUJOCO_GL="off")
    assert "MUJOCO_GL" in _complaint(done)
    assert not (tmp_path / "store").exists()


def test_task_script_collects(tmp_path):
    store = tmp_path / "store"
    done = _call(SCRIPT, "collect", "--episodes", 1, "--store", store)
    assert (done.returncode, done.stderr) == (0, "")
    assert "1 succeeded" in done.stdout
    assert _call(SHEATH, "data", "check", store).returncode == 0


@pytest.mark.soak
def test_who_has_read_enough_of_it_is_told_nothing_more():
    for argv in (["train", "--help"], ["tasks"]):
        reading, writing = os.pipe()
        os.close(reading)
        try:
            done = subprocess.run(
                [*SHEATH, *argv],
                stdout=writing,
                stderr=subprocess.PIPE,
                text=True,
                timeout=DEADLINE_S,
                check=False,
            )
        finally:
            os.close(writing)
        # rich, which prints the tables, ends with 1.
        assert done.returncode in {1, 141}
        assert done.stderr == ""
