"""A package of somebody else adds a member of each kind: one file and one line."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
GUEST = ROOT / "tests" / "guest_package"
PROJECT = tomllib.loads((GUEST / "pyproject.toml").read_text())["project"]
SUITES = """
from guest.every_kth import EveryKth
from sheath_manip.gates.making import GATES
from sheath_manip.learning.methods import METHODS
from sheath_manip.policies import EMBEDDINGS, POLICIES, embeddings_like
from sheath_manip.tasks.table import TASKS
from sheath_manip.testing import *
from sheath_manip.types import Observation, Proposal
import numpy as np

task = TASKS["slide"]
check_task(task)
spec = task.make().spec
states = drawn_states(spec)
check_policy(POLICIES["ridge"], spec, states)
check_embedding(EMBEDDINGS["squares"], POLICIES["ridge"](spec).fit(states), states)
seen = [Observation({}, np.zeros(1, np.float32), 0.1 * step) for step in range(9)]
check_gate(lambda: EveryKth(3), seen, [Proposal(np.zeros((1, 1), np.float32))] * 9)
assert "every-kth" in GATES and METHODS["every-kth"].name == "every-kth"
assert embeddings_like("squares") == ["squares"]
print("passed")
"""


@pytest.fixture(scope="module")
def environment(tmp_path_factory) -> dict[str, str]:
    """Environment variables with which the guest is installed, as an installer leaves it."""
    site = tmp_path_factory.mktemp("site")
    info = site / f"{PROJECT['name']}-{PROJECT['version']}.dist-info"
    info.mkdir()
    head = f"Metadata-Version: 2.1\nName: {PROJECT['name']}\nVersion: {PROJECT['version']}\n"
    (info / "METADATA").write_text(head)
    groups = [
        f"[{group}]\n" + "".join(f"{name} = {target}\n" for name, target in members.items())
        for group, members in PROJECT["entry-points"].items()
    ]
    (info / "entry_points.txt").write_text("\n".join(groups))
    path = os.pathsep.join([str(site), str(GUEST), str(ROOT)])
    return os.environ | {"PYTHONPATH": path, "COLUMNS": "200"}


def run(environment: dict[str, str], *argv: object) -> str:
    done = subprocess.run(
        [sys.executable, *map(str, argv)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def sheath(environment: dict[str, str], *argv: object) -> str:
    main = "import sys; from sheath_manip.command import main; sys.exit(main(sys.argv[1:]))"
    return run(environment, "-c", main, *argv)


def test_its_members_pass_the_suites_by_import(environment):
    assert run(environment, "-c", SUITES) == "passed\n"


def test_the_command_learns_its_task_with_its_members(environment, tmp_path):
    learn = ("learn", "slide", "--runs", tmp_path / "runs", "--method", "every-kth")
    plan = ("--policy.name", "ridge", "--gate.signal", "support", "--gate.embedding", "squares")
    size = ("--demonstrations", 3, "--calibration", 3, "--false-alarm-episodes", 1)
    rounds = ("--rounds", 1, "--episodes", 2, "--evaluation-episodes", 1, "--final-episodes", 1)
    out = sheath(environment, *learn, *plan, *size, *rounds)
    assert "the last policy and its gate" in out
    last = tmp_path / "runs" / "s0" / "every-kth" / "round-01.npz"
    assert "succeeded" in sheath(
        environment, "evaluate", "slide", "--checkpoint", last, "--episodes", 2
    )


def test_docs_say_how_many_files_and_lines_a_member_takes():
    table = (ROOT / "docs" / "extending.md").read_text()
    kinds = {
        "task": "slide",
        "policy": "ridge",
        "embedding": "squares",
        "gate and method": "every_kth",
    }
    for kind, module in kinds.items():
        lines = len((GUEST / "guest" / f"{module}.py").read_text().splitlines())
        added = sum(
            target.startswith(f"guest.{module}:")
            for members in PROJECT["entry-points"].values()
            for target in members.values()
        )
        assert re.search(rf"\| {kind} \|.*`{module}\.py` \| {lines} \| {added} \|", table), (
            f"docs/extending.md: wanted {kind} | `{module}.py` | {lines} | {added}"
        )
