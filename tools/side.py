"""A version of the code that a bench holds against another, in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

from sheath_manip.protocols.closing import Closes

HERE = Path(__file__).resolve().parents[1]
SCRIPTS = HERE / "tools" / "sides"


class Side(Closes):
    """A process that measures whenever it is told to; a checkout's own code runs in it.

    It runs one of the scripts in `tools/sides`, which prints a number once it is ready, and then
    one for each line that it is sent.
    """

    def __init__(self, checkout: Path, script: str, *arguments: object) -> None:
        """Start the script of that name, and wait until it is ready."""
        environment = os.environ | {
            "PYTHONPATH": str(checkout),
            "OMP_NUM_THREADS": "1",
            "MKL_NUM_THREADS": "1",
        }
        self._process = subprocess.Popen(
            [sys.executable, str(SCRIPTS / script), *map(str, arguments)],
            env=environment,
            cwd=checkout,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.first = self._answer()
        """what it told when it was ready"""

    def measured(self) -> float:
        """Have it measure once more; return the number that it tells."""
        assert self._process.stdin is not None
        self._process.stdin.write("go\n")
        self._process.stdin.flush()
        return self._answer()

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()

    def _answer(self) -> float:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit(f"{self._process.args} ended; wanted a figure from it")
        return float(line)
