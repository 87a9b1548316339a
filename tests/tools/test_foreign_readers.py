"""zarr-python 2, in a venv where nothing is ours, reads an exported ReplayBuffer to the bit."""

import subprocess
from pathlib import Path

import pytest

from tools.foreign_readers import (
    READERS,
    make_venv,
    read_back,
    run,
    synthetic_store,
    write_expected,
)

ZARR_2 = READERS["zarr2"]


@pytest.fixture(scope="module")
def python(pytestconfig, tmp_path_factory) -> Path:
    """Of the venv, kept in pytest's cache; skips where no registry gives its packages."""
    cache = getattr(pytestconfig, "cache", None)
    folder = cache.mkdir("zarr-2.18.7") if cache else tmp_path_factory.mktemp("zarr-2.18.7")
    with pytest.MonkeyPatch.context() as patch:
        # Without a network this shall take seconds.
        patch.setenv("PIP_RETRIES", "0")
        patch.setenv("PIP_DEFAULT_TIMEOUT", "10")
        try:
            return make_venv(folder, ZARR_2)
        except subprocess.CalledProcessError as error:
            pytest.skip(f"no registry gives {' '.join(ZARR_2.packages)} ({error})")


@pytest.mark.soak
def test_a_replay_buffer_in_a_directory_and_in_a_zip(python: Path, tmp_path: Path) -> None:
    store = synthetic_store(tmp_path / "store", episodes=2)
    said = read_back(ZARR_2, python, store, tmp_path)
    # All that is stored, and the requested action.
    arrays = 2 * (len(store.recorded(store.names()[0]).arrays) + 1)
    assert said == [f"zarr 2.18.7: 2 episodes, 141 steps, {arrays} arrays equal"] * 2
    # The reader would notice.
    other = synthetic_store(tmp_path / "other", episodes=2, length=69)
    write_expected(other, tmp_path / "other.npz")
    with pytest.raises(subprocess.CalledProcessError):
        run(python, ZARR_2.script, tmp_path / ZARR_2.targets[0], tmp_path / "other.npz")
