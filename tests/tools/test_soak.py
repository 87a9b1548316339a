import pytest

from sheath_manip.dataset.store import EpisodeStore
from tools.soak import main


@pytest.mark.soak
def test_a_short_one_leaves_whole_episodes(tmp_path, capsys):
    argv = ["--minutes", "0.15", "--speed", "20", "--store", str(tmp_path / "store")]
    # What the first seconds do to the memory says nothing.
    main(argv)
    assert ", 0 faults" in capsys.readouterr().out
    assert EpisodeStore(tmp_path / "store").names()
