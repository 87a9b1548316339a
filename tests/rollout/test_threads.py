"""The number of threads that results to the bit hold for."""

import os

import pytest

from sheath_manip.rollout.threads import one_thread_by_default

NAME = "OMP_NUM_THREADS"


@pytest.mark.parametrize(("told", "taken"), [(None, "1"), ("", "1"), ("3", "3")])
def test_one_thread_unless_a_number_is_told(monkeypatch, told, taken):
    monkeypatch.setenv(NAME, "undone afterwards")
    if told is None:
        monkeypatch.delenv(NAME)
    else:
        monkeypatch.setenv(NAME, told)
    one_thread_by_default()
    assert os.environ[NAME] == taken
