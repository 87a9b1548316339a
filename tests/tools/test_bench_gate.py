import json
from pathlib import Path

from sheath_manip.experiments.claims import verdicts
from tools.bench_gate import main


def test_a_quick_run_writes_what_claims_read(tmp_path: Path, capsys) -> None:
    main(["--quick", "--results", str(tmp_path)])
    lines = json.loads((tmp_path / "bench-gate.json").read_text())
    for line in lines.values():
        assert list(line) == ["value", "unit", "goal", "holds", "how"]
    found = verdicts(tmp_path, {})
    assert [verdict.name for verdict in found] == list(lines)
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == len(lines)
    # Speed depends on the machine and these sizes; what the scores are does not.
    for name, line in lines.items():
        assert line["holds"] or not name.startswith(("agreement", "same sign", "memory")), name
