from pathlib import Path

from tools.kill_recorder import KillReport, kill_recorder


def test_two_writers_and_a_reader_beside_kills(tmp_path: Path) -> None:
    """Few of them; `make soak` has more."""
    report = kill_recorder(tmp_path / "store", kills=2, writers=2, polls=5)
    assert report.lossless, report
    assert report.kills == 2
    assert str(report).startswith("2 kills, ")
    assert report.polls >= 5
    assert report.committed > 0


def test_a_lost_episode_is_no_pass() -> None:
    assert not KillReport(1, 1, (), ("learning-s0-r00-i000-seed0",), 0).lossless
    assert not KillReport(1, 1, ("learning-s0-r00-i000-seed0",), (), 0).lossless
