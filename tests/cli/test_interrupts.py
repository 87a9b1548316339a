"""An interruption is one line, wherever it falls."""

import ctypes
import os
import signal
from collections.abc import Iterator

import pytest

from sheath_manip.cli import entry
from sheath_manip.cli.interrupts import interruptible


@pytest.fixture(autouse=True)
def _heard() -> Iterator[None]:
    """A shell starts what runs in the background deaf to SIGINT, tests too."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupt() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def swallowed() -> None:
    """As a C function does whose argument is being converted."""
    try:
        interrupt()
    except KeyboardInterrupt as error:
        raise ctypes.ArgumentError("argument 1: KeyboardInterrupt") from error


@pytest.mark.parametrize("happens", [interrupt, swallowed])
def test_it_is_one_line(sheath, monkeypatch, happens) -> None:
    monkeypatch.setattr("sheath_manip.dataset.locations.open_store", lambda _: happens())
    monkeypatch.setattr("sheath_manip.dataset.table.open_store", lambda _: happens())
    code, out, err = sheath("data", "list", "x")
    assert (code, out) == (entry.INTERRUPTED, "")
    assert err == "sheath: interrupted; what was recorded is kept\n"


def test_an_error_of_its_own_is_none(sheath, monkeypatch) -> None:
    def broken(_: str) -> None:
        raise ctypes.ArgumentError("argument 1: wrong type")

    monkeypatch.setattr("sheath_manip.dataset.table.open_store", broken)
    with pytest.raises(ctypes.ArgumentError):
        sheath("data", "list", "x")


def test_another_handler_stays() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interruptible() as interruption:
            interrupt()
        assert not interruption.came
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
