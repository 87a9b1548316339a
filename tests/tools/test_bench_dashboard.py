import json

import pytest

from tools.bench_dashboard import main


@pytest.mark.slow
def test_it_measures_every_line(tmp_path):
    main(["--quick", "--results", str(tmp_path)])
    lines = json.loads((tmp_path / "bench-dashboard.json").read_text())
    assert len(lines) == 5
    # Of times nothing is asserted here, and of steps all.
    for name in ("taking over acts within", "the emergency stop acts within"):
        assert lines[name]["holds"], lines[name]
