"""Other projects' packages, each in a venv of its own, read and drive to the bit what is ours."""

import subprocess
from pathlib import Path

import pytest

from tools.foreign_readers import (
    READERS,
    Reader,
    drive,
    make_venv,
    read_back,
    run,
    synthetic_store,
    write_expected,
)

ZARR_2, LEROBOT = READERS["zarr2"], READERS["lerobot"]


def venv_of(reader: Reader, name: str, pytestconfig, tmp_path_factory) -> Path:
    """Its Python, kept in pytest's cache; skips where no registry gives its packages."""
    cache = getattr(pytestconfig, "cache", None)
    folder = cache.mkdir(name) if cache else tmp_path_factory.mktemp(name)
    with pytest.MonkeyPatch.context() as patch:
        # Without a network this shall take seconds.
        patch.setenv("PIP_RETRIES", "0")
        patch.setenv("PIP_DEFAULT_TIMEOUT", "10")
        try:
            return make_venv(folder, reader)
        except subprocess.CalledProcessError as error:
            pytest.skip(f"no registry gives {' '.join(reader.packages)} ({error})")


@pytest.fixture(scope="module")
def python(pytestconfig, tmp_path_factory) -> Path:
    return venv_of(ZARR_2, "zarr-2.18.7", pytestconfig, tmp_path_factory)


@pytest.fixture(scope="module")
def lerobots_python(pytestconfig, tmp_path_factory) -> Path:
    return venv_of(LEROBOT, "lerobot-0.4.4", pytestconfig, tmp_path_factory)


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


@pytest.mark.soak
def test_lerobots_policies_drive_as_in_its_own_loop(lerobots_python: Path, tmp_path: Path) -> None:
    loops, page = drive(LEROBOT, lerobots_python, tmp_path)
    assert loops == (
        "lerobot 0.4.4: 23 steps equal to the bit; act: 5 passes, act averaging: 23 passes, "
        "diffusion: 5 passes"
    )
    assert page.startswith("docs/own/lerobot.md: success, the expert acted in ")
