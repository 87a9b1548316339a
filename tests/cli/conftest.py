"""The command in this process, on the toy task."""

from collections.abc import Callable
from pathlib import Path

import pytest

from sheath_manip.cli.entry import run_command
from tests.toy import CATALOG
from tests.writing import writes_here

__all__ = ["writes_here"]

Call = Callable[..., tuple[int, str, str]]
"""exit code, standard output, standard error"""


def run(*argv: object) -> int:
    """Run the command; return its exit code."""
    try:
        return run_command(lambda: CATALOG, [str(word) for word in argv])
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1


@pytest.fixture
def sheath(capsys, monkeypatch) -> Call:
    """Call the command: `sheath("data", "list", path)`."""
    monkeypatch.setenv("COLUMNS", "200")

    def call(*argv: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = run(*argv)
        return code, *capsys.readouterr()

    return call


@pytest.fixture
def complaint(sheath) -> Callable[..., str]:
    """Call the command with something bad; return the one line that it says."""

    def call(*argv: object) -> str:
        code, _, err = sheath(*argv)
        assert code == 2
        assert err.startswith("sheath: ")
        assert err.count("\n") == 1
        return err

    return call


@pytest.fixture(scope="session")
def made(tmp_path_factory) -> Path:
    """A directory with a `store` of 8 demonstrations and a `first.npz` trained on 5 of them."""
    directory = tmp_path_factory.mktemp("corridor")
    store, checkpoint = directory / "store", directory / "first.npz"
    assert run("collect", "corridor", "--store", store, "--episodes", 8) == 0
    assert run("train", "corridor", "--store", store, "--checkpoint", checkpoint) == 0
    return directory
