import json
from pathlib import Path

from sheath_manip.experiments.claims import verdicts
from sheath_manip.tasks.table import TASKS
from tools.bench_data import main


def test_a_quick_run_writes_what_claims_read(tmp_path: Path, monkeypatch, capsys) -> None:
    # It measures the disk that it is started on.
    monkeypatch.chdir(tmp_path)
    main(["--quick", "--results", str(tmp_path)])
    lines = json.loads((tmp_path / "bench-data.json").read_text())
    for line in lines.values():
        assert list(line) == ["value", "unit", "goal", "holds", "how"]
    assert [verdict.name for verdict in verdicts(tmp_path, {})] == list(lines)
    assert len(capsys.readouterr().out.splitlines()) == len(lines)
    assert len(lines) == 2 + len(TASKS)
    assert [path.name for path in tmp_path.iterdir()] == ["bench-data.json"]
