"""The tool that tries arms writes what the docs' page of arms is made from."""

import json
from pathlib import Path

import pytest

from tools.docs.pages import ROOT
from tools.try_arms import main


@pytest.mark.soak
def test_an_arm_that_is_tried_is_told_beside_the_others(tmp_path: Path) -> None:
    (tmp_path / "arms.json").write_text('{"other": {}}')
    main(["--arms", "own", "--quick", "--results", str(tmp_path)])
    found = json.loads((tmp_path / "arms.json").read_text())
    assert list(found) == ["other", "own"]
    committed = json.loads((ROOT / "results" / "arms.json").read_text())["own"]
    assert list(found["own"]) == list(committed)
    assert (found["own"]["grasp"]["grasped"], found["own"]["gauze"]["freed"]) == (1, 1)


def test_ur5e_and_panda_grasp_in_all_scenes_within_the_time_for_kinematics() -> None:
    found = json.loads((ROOT / "results" / "arms.json").read_text())
    for name in ("ur5e", "panda"):
        grasp = found[name]["grasp"]
        assert (grasp["scenes"], grasp["grasped"]) == (20, 20)
        assert grasp["ik_ms"] <= 2.0
