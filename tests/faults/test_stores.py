"""Whatever harms a store is survived and told; `make soak` tries each kind, and many times."""

import pytest

from tests.faults.stores_section import ALL, QUICK, verdicts


def _not_clean(count: int, seed: int) -> list[str]:
    found = verdicts(count, seed)
    assert len(found) == count
    return [f"{each.kind} {each.case}" for each in found if not (each.survived and each.told)]


FEW = 8
"""stores, each harmed in another way"""


def test_a_few_kinds() -> None:
    assert _not_clean(FEW, seed=1) == []


@pytest.mark.soak
def test_one_store_of_each_kind() -> None:
    assert _not_clean(QUICK, seed=1) == []


@pytest.mark.soak
def test_many_stores_of_each_kind() -> None:
    assert _not_clean(ALL, seed=0) == []
