"""Whatever fails in the control loop, the run comes to an end, and nothing of it is lost."""

import pytest

from tests.faults.loop_cases import Case, all_cases, few_of
from tests.faults.loop_section import verdict_of

FEW = few_of(all_cases(), 2, seed=1)


def named(case: Case) -> str:
    return f"{case.kind}-{case.name}"


@pytest.mark.parametrize("case", FEW, ids=named)
def test_a_fault_is_survived_and_told(case, tmp_path, dropped_listeners):
    verdict = verdict_of(case, tmp_path / "store", seed=3)
    dropped_listeners.clear()
    assert verdict.survived, verdict.case
    assert verdict.told, verdict.case


def test_there_are_enough_cases():
    assert len(all_cases()) >= 300


@pytest.mark.soak
@pytest.mark.parametrize("case", all_cases(), ids=named)
def test_all_of_them(case, tmp_path, dropped_listeners):
    test_a_fault_is_survived_and_told(case, tmp_path, dropped_listeners)
