"""What it is to import the package: its names, what they cost, and what they do without."""

import inspect
import os
import subprocess
import sys
from pathlib import Path

import pytest

import sheath_manip
from sheath_manip import rollout
from tests.waiting import DEADLINE_S

ROOT = Path(__file__).parents[1]
HEAVY = ("cv2", "dm_control", "mujoco", "numpy", "sklearn", "torch", "zarr")
ABOVE_THE_CORE = ("assets", "controllers", "tasks")

# For `find_spec` and the import statement alike, a module that is None is not installed.
WITHOUT_SIMULATOR = """
import sys
sys.modules |= dict.fromkeys(("mujoco", "dm_control", "mink", "daqp"))
"""
# A format of another project may want an extra of its own, which it then names.
IMPORT_ALL = """
from contextlib import suppress
from importlib import import_module
from sheath_manip.exceptions import SetupError

for name in sys.argv[1:]:
    with suppress(SetupError):
        import_module(name)
"""
TOY_ROLLOUT = """
import numpy as np
from sheath_manip import EpisodeInfo
from sheath_manip.gates import AlwaysExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Purpose
from tests.toy import Corridor, MiddleKeeper

corridor = Corridor()
info = EpisodeInfo("corridor", 4, Purpose.DEMONSTRATION, 50.0)
rng = np.random.default_rng(0)
print(rollout(corridor, info, AlwaysExpert(), rng=rng, expert=MiddleKeeper(corridor)).outcome)
"""
# Told of each first import: what is there by then?
WHAT_IS_THERE = """
import sys

class Spy:
    def find_spec(self, name, path=None, target=None):
        if name in ("mujoco", "dm_control"):
            print(name, [other for other in ("torch", "triton") if other in sys.modules])

sys.meta_path.insert(0, Spy())
"""


def _python(code: str, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
        check=False,
    )


def _printed(code: str, *arguments: str, **environment: str) -> list[str]:
    done = _python(code, *arguments, **environment)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.parametrize("name", sheath_manip.__all__)
def test_each_public_name_is_there_and_documented(name: str) -> None:
    assert inspect.getdoc(getattr(sheath_manip, name))
    assert name in dir(sheath_manip)


def test_another_name_is_none() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Robot'"):
        sheath_manip.Robot  # noqa: B018  # pyright: ignore[reportAttributeAccessIssue]


def test_the_loop_is_a_function_of_its_room() -> None:
    assert inspect.isfunction(rollout.rollout)


def test_the_package_alone_and_the_commands_help_import_little() -> None:
    loaded = "print([name for name in sys.argv[1:] if name in sys.modules])"
    assert _printed(f"import sys, sheath_manip\n{loaded}", *HEAVY) == ["[]"]
    # tyro ends the process once it has printed the help.
    helped = f"import atexit, sys\natexit.register(lambda: {loaded})\nsys.argv[1:1] = ['--help']\n"
    call = "from sheath_manip.command import main\nmain(['--help'])"
    assert _printed(helped + call, "dm_control", "mujoco", "torch")[-1] == "[]"


def test_torch_is_there_before_any_task_can_open_a_gl_context(tmp_path: Path) -> None:
    # Where torch is a CPU build no triton is installed.
    (tmp_path / "triton.py").touch()
    path = os.pathsep.join((str(ROOT), str(tmp_path)))
    opened = "from sheath_manip.tasks.table import TASKS\nTASKS['driving']\n"
    seen = _printed(WHAT_IS_THERE + opened, PYTHONPATH=path)
    # Each may be looked for several times.
    assert set(seen) == {"dm_control ['torch', 'triton']", "mujoco ['torch', 'triton']"}


def test_the_core_wants_no_simulator() -> None:
    package = ROOT / "sheath_manip"
    modules = [
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        for path in sorted(package.rglob("*.py"))
        if path.relative_to(package).parts[0] not in ABOVE_THE_CORE
        # Imported where somebody's environment has brought MuJoCo itself.
        and not path.stem.startswith("mujoco_")
    ]
    assert len(modules) > 100
    assert _printed(WITHOUT_SIMULATOR + IMPORT_ALL + TOY_ROLLOUT, *modules) == ["success"]


def test_a_verb_that_wants_the_tasks_says_how_to_install_them() -> None:
    call = "from sheath_manip.command import main\nsys.exit(main(['tasks']))"
    done = _python(WITHOUT_SIMULATOR + call)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "pip install 'sheath-manip[tasks]'" in done.stderr
