import pytest

from sheath_manip.dataset.store import EpisodeStore
from tools.soak import GROWTH, Memory, main


@pytest.mark.parametrize(("grown_mb", "grows"), [(1.0, False), (20.0, True)])
def test_what_grows_after_the_warm_up_counts(grown_mb, grows):
    memory = Memory(every_s=1.0)
    # A cache that fills in the first third is no leak.
    memory.samples = [(float(t), 100.0 + min(t, 30) + grown_mb * t / 100) for t in range(100)]
    assert (memory.growth() > GROWTH) is grows


@pytest.mark.soak
def test_a_short_one_leaves_whole_episodes(tmp_path, capsys):
    argv = ["--minutes", "0.15", "--speed", "20", "--store", str(tmp_path / "store")]
    # What the first seconds do to the memory says nothing.
    main(argv)
    assert ", 0 faults" in capsys.readouterr().out
    assert EpisodeStore(tmp_path / "store").names()
