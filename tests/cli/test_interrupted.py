"""Ctrl-C is one line and exit code 130, whenever it comes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.waiting import DEADLINE_S

LINE = "sheath: interrupted; what was recorded is kept\n"
BEGIN = """
import atexit, os, signal, sys
from sheath_manip import command
def interrupted():
    os.kill(os.getpid(), signal.SIGINT)
    return 0
def by_an_import():
    try:
        import interrupting
    except BaseException:
        # As some modules do, whose C code calls back.
        raise ImportError("cannot import name") from None
"""
MOMENTS = {
    "while it works": "command._run(interrupted)",
    "while modules load": "command._run(by_an_import)",
    "at its end": "atexit.register(interrupted); command._run(lambda: 0)",
}


@pytest.mark.parametrize("moment", MOMENTS)
def test_one_line_whenever_it_comes(tmp_path: Path, moment: str) -> None:
    (tmp_path / "interrupting.py").write_text(
        "import os, signal\nos.kill(os.getpid(), signal.SIGINT)"
    )
    run = MOMENTS[moment]
    *before, last = run.split("; ")
    code = "\n".join([BEGIN, *before, f"sys.exit({last})"])
    path = os.pathsep.join(filter(None, [str(tmp_path), *sys.path]))
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
        check=False,
    )
    assert (done.returncode, done.stderr) == (130, LINE)


@pytest.mark.soak
@pytest.mark.parametrize("after_s", [0.5, 1.5, 3.0, 5.0, 8.0])
def test_a_terminals_ctrl_c_reaches_workers_too_and_none_says_anything(
    tmp_path: Path, after_s: float
) -> None:
    code = "import sys; from sheath_manip.command import main; sys.exit(main(sys.argv[1:]))"
    collect = ("collect", "driving", "--store", tmp_path / "store", "--workers", 2)
    with subprocess.Popen(
        [sys.executable, "-c", code, *map(str, collect), "--episodes", "200"],
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        time.sleep(after_s)
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=DEADLINE_S)
    assert (process.returncode, said) == (130, LINE)
