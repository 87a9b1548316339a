"""Spoiled checkpoints and files of other tools: none ends in a traceback, hangs or changes data."""

import resource
from collections.abc import Iterator

import pytest

from tests.faults import checkpoint_section, exchange_section
from tests.faults.counting import Verdict

MOST_MB = 512
"""that reading all of them may add to the memory of the process"""


def peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def require_clean(verdicts: Iterator[Verdict], at_least: int) -> None:
    before_mb = peak_mb()
    held = list(verdicts)
    assert [each.case for each in held if not (each.survived and each.told)] == []
    assert len(held) >= at_least
    assert peak_mb() - before_mb < MOST_MB


def test_spoiled_checkpoints_of_each_kind() -> None:
    checkpoint_section.checkpoint(0)
    require_clean(checkpoint_section.verdicts(3), at_least=40)


@pytest.mark.soak
def test_spoiled_files_of_other_tools_of_each_kind() -> None:
    exchange_section.sound()
    require_clean(exchange_section.verdicts(1), at_least=35)


@pytest.mark.soak
def test_many_spoiled_checkpoints() -> None:
    require_clean(checkpoint_section.verdicts(checkpoint_section.OF_EACH), at_least=400)


@pytest.mark.soak
def test_many_spoiled_files_of_other_tools() -> None:
    require_clean(exchange_section.verdicts(exchange_section.OF_EACH), at_least=600)
