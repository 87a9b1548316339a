"""Runs that were killed and run again leave what those do that nothing killed: few of them."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.waiting import DEADLINE_S
from tools.kill_runs import Kills

TOY = ("--task", "corridor", "--catalog", "tests.toy:CATALOG")


@pytest.mark.soak
def test_killed_recordings_of_the_toy_task(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tools.kill_runs", *TOY, "--kills", "3", "--verbs", "collect"]
    command += ["--results", str(tmp_path)]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=2 * DEADLINE_S, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    written = json.loads((tmp_path / "kills.json").read_text())
    found = written["corridor"]["collect"]
    assert (found["kills"], found["hangs"], found["tracebacks"]) == (3, 0, 0)
    assert found["same"] == found["runs"] > 0
    assert sum(found["by_victim"].values()) == 3


def test_a_run_that_differs_is_no_pass() -> None:
    assert Kills(kills=3, runs=2, same=2).lossless
    assert not Kills(kills=3, runs=2, same=1).lossless
    assert not Kills(kills=3, runs=2, same=2, hangs=1).lossless
    assert not Kills(kills=3, runs=2, same=2, tracebacks=1).lossless
