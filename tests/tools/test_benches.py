"""Benches write what `sheath claims` reads; each of them, in small, is for `make soak`."""

import json
from importlib import import_module
from pathlib import Path

import pytest

from sheath_manip.experiments.claims import verdicts
from tools.bench import Line, at_least, at_most, medians, run_bench

ALIKE = {
    "dashboard": ("taking over", "the emergency stop"),
    "data": (),
    "env": ("expert", "toppled"),
    "gate": ("agreement", "same sign", "memory"),
    "gauze": ("expert", "MuJoCo", "error"),
    "person": ("platformer: median",),
    "platformer": ("expert",),
    "scale": (),
    "wall": (),
}
"""by bench, beginnings of the lines that hold on any machine and at any size"""


def written(name: str, folder: Path) -> dict[str, dict]:
    """The lines in a bench's file, which `sheath claims` can read."""
    lines = json.loads((folder / f"bench-{name}.json").read_text())
    for line in lines.values():
        assert list(line) == ["value", "unit", "goal", "holds", "how"]
    assert [verdict.name for verdict in verdicts(folder, {})] == list(lines)
    assert [path.name for path in folder.iterdir()] == [f"bench-{name}.json"]
    return lines


def test_a_bench_prints_and_writes_a_line_a_number(tmp_path: Path, capsys) -> None:
    sizes: list[int] = []

    def measure(size: int) -> dict[str, Line]:
        sizes.append(size)
        return {"high": at_least(2, 1, "m", ""), "low": at_most(2, 1, "m", "once")}

    folder = tmp_path / "results"
    for quick in ([], ["--quick"]):
        run_bench("toy", "A toy.", [measure], 9, 3, [*quick, "--results", str(folder)])
        lines = written("toy", folder)
        assert {name: line["holds"] for name, line in lines.items()} == {"high": True, "low": False}
        assert len(capsys.readouterr().out.splitlines()) == len(lines)
    assert sizes == [9, 3]


def test_the_sides_of_a_ratio_take_turns() -> None:
    calls: list[str] = []
    times = iter(range(100))
    theirs, ours = medians(
        lambda: calls.append("theirs"),
        lambda: calls.append("ours"),
        rounds=3,
        clock=lambda: float(next(times)),
    )
    assert calls == ["theirs", "ours"] * 3
    assert (theirs, ours) == (1, 1)


@pytest.mark.soak
@pytest.mark.parametrize("name", sorted(ALIKE))
def test_a_quick_run(name: str, tmp_path: Path, monkeypatch, capsys) -> None:
    if name == "data":
        # It measures the disk that it is started on.
        monkeypatch.chdir(tmp_path)
    folder = tmp_path / "results"
    import_module(f"tools.bench_{name}").main(["--quick", "--results", str(folder)])
    lines = written(name, folder)
    assert len(capsys.readouterr().out.splitlines()) == len(lines)
    for title, line in lines.items():
        assert line["holds"] or not title.startswith(ALIKE[name]), (title, line)
