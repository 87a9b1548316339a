"""A directory that LeRobot cannot be asked about, or no LeRobot: one line, before anything else."""

import sys

import pytest

from sheath_manip.adapters.lerobot import load_policy
from sheath_manip.exceptions import CheckpointError, ParameterError, SetupError, UnknownNameError
from tests.adapters.lerobot_stand_in import SPEC, config, write_directory


def test_without_lerobot_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "lerobot", None)
    path = write_directory(tmp_path / "policy", config())
    with pytest.raises(SetupError, match=r"pip install 'sheath-manip\[lerobot\]'"):
        load_policy(path, spec=SPEC)


def test_what_is_no_policys_directory(tmp_path):
    with pytest.raises(
        CheckpointError, match=r"has no config.json, .* wanted a policy's directory"
    ):
        load_policy(tmp_path)
    older = write_directory(tmp_path / "older", config())
    (older / "policy_preprocessor.json").unlink()
    with pytest.raises(
        CheckpointError, match=r"no policy_preprocessor.json; .*migrate_policy_norm"
    ):
        load_policy(older)


def test_a_trainings_output_says_where_its_policy_is(tmp_path):
    inside = write_directory(tmp_path / "out" / "checkpoints" / "000100" / "pretrained_model", {})
    with pytest.raises(CheckpointError, match=f"its policy is in {inside}"):
        load_policy(tmp_path / "out")


@pytest.mark.parametrize("content", ["[]", "{", '{"type": NaN}', '{"type": "act"} {}'])
def test_a_config_that_is_none(tmp_path, content):
    path = write_directory(tmp_path / "policy", {})
    (path / "config.json").write_text(content)
    with pytest.raises(CheckpointError, match=r"config\.json (cannot be read|holds no object)"):
        load_policy(path)


def test_another_kind_of_policy(tmp_path):
    path = write_directory(tmp_path / "policy", config(type="smolvla"))
    with pytest.raises(UnknownNameError, match="'smolvla'; known: act, diffusion"):
        load_policy(path)


def test_a_policy_of_another_task(tmp_path):
    wide = config(output_features={"action": {"type": "ACTION", "shape": [7]}})
    with pytest.raises(
        CheckpointError, match=r"have 7 numbers; wanted the 2 of .* \(left, right\)"
    ):
        load_policy(write_directory(tmp_path / "wide", wide), spec=SPEC)
    with pytest.raises(CheckpointError, match="names no shape of an action"):
        load_policy(write_directory(tmp_path / "mute", config(output_features={})), spec=SPEC)
    state = {"observation.state": {"type": "STATE", "shape": [9]}}
    other = write_directory(tmp_path / "other", config(input_features=state))
    with pytest.raises(ParameterError, match="observation has 5 features"):
        load_policy(other, spec=SPEC)
