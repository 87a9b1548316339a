"""The examples run as a reader runs them, and each draws its picture."""

import runpy
import signal
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from PIL import Image

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
MOST_LINES = 60


def run(monkeypatch: pytest.MonkeyPatch, name: str, *arguments: object) -> None:
    monkeypatch.setattr(sys, "argv", [name, *map(str, arguments)])
    # The command ends a program that is interrupted; this one goes on.
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")


def drawn(path: Path) -> tuple[int, int]:
    with Image.open(path) as image:
        assert len(image.convert("RGB").getcolors(1 << 24) or ()) > 20
        return image.size


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_each_is_short_says_how_it_is_run_and_has_its_picture(path: Path) -> None:
    text = path.read_text()
    assert len(text.splitlines()) < MOST_LINES
    assert f"python examples/{path.name}" in text.split('"""')[1]
    assert drawn(ROOT / "docs" / "examples" / f"{path.stem}.png")[0] >= 720


def test_an_expert_is_recorded_and_looked_at_and_lerobot_says_what_it_wants(
    monkeypatch, tmp_path, capsys
) -> None:
    picture, store = tmp_path / "lap.png", tmp_path / "store"
    run(monkeypatch, "roll_out", "--store", store, "--picture", picture)
    assert "success" in capsys.readouterr().out
    # Three frames of 720 px: the first moment, one in the middle, the last observation.
    assert drawn(picture)[0] == 3 * 720
    # LeRobot is not among the development packages; tools/foreign_readers.py reads with it.
    monkeypatch.setitem(sys.modules, "lerobot", None)
    with pytest.raises(SystemExit, match="2"):
        run(monkeypatch, "export_to_lerobot", store, tmp_path / "dataset")
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "pip install 'sheath-manip[lerobot]'" in said
    assert not (tmp_path / "dataset").exists()


def test_a_policy_is_trained_and_gated(monkeypatch, tmp_path, capsys) -> None:
    run(monkeypatch, "train_and_gate", "--demonstrations", 4, "--picture", tmp_path / "gated.png")
    assert "the expert acted in" in capsys.readouterr().out
    assert drawn(tmp_path / "gated.png")[0] == 3 * 720


def test_a_task_in_one_file_keeps_the_contract_and_is_driven(monkeypatch, tmp_path) -> None:
    run(monkeypatch, "own_task", tmp_path / "cart.png")
    assert drawn(tmp_path / "cart.png")[0] == 3 * 720


def test_a_torch_network_is_gated(monkeypatch, tmp_path, capsys) -> None:
    run(monkeypatch, "gate_a_torch_policy", tmp_path / "gated.png", 150)
    assert "the expert acted in" in capsys.readouterr().out
    assert drawn(tmp_path / "gated.png")[0] == 3 * 720


def test_a_plain_loop_is_gated_from_recordings_alone(monkeypatch, tmp_path, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    # It is imported by its own name, as the file of the policy.
    monkeypatch.setattr(sys, "path", list(sys.path))
    try:
        run(monkeypatch, "gate_a_control_loop", "gated.png")
    finally:
        sys.modules.pop("gate_a_control_loop", None)
        plt.close("all")
    said = capsys.readouterr().out
    assert "false alarms" in said
    assert "alone: into the wall\ngated: through" in said
    assert drawn(tmp_path / "gated.png")[0] >= 720
