"""Where episodes run, as a value."""

import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.rollout.executing import Executing
from sheath_manip.rollout.processes import ProcessExecutor
from sheath_manip.rollout.serial import SerialExecutor


@pytest.mark.parametrize("said", [Executing(), Executing(workers=0), Executing("serial")])
def test_without_workers_all_runs_here(said) -> None:
    assert said.here
    with said.made() as executor:
        assert isinstance(executor, SerialExecutor)


@pytest.mark.parametrize("said", [Executing(workers=2), Executing("processes"), Executing("ray")])
def test_with_workers_it_runs_elsewhere(said) -> None:
    assert not said.here


def test_processes_are_made() -> None:
    with Executing("processes", 3).made() as executor:
        assert isinstance(executor, ProcessExecutor)


@pytest.mark.parametrize(
    ("said", "then"),
    [
        (Executing(), Executing(workers=2)),
        (Executing("processes"), Executing("processes", 2)),
        (Executing(workers=0), Executing(workers=0)),
        (Executing("serial"), Executing("serial")),
        # All cores of the cluster, not two.
        (Executing("ray"), Executing("ray")),
    ],
)
def test_what_is_usual_holds_where_nothing_was_said(said, then) -> None:
    assert said.by_default(2) == then


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"workers": -1}, "workers is -1; wanted at least 0"),
        ({"executor": "ray", "workers": 0}, "wanted at least 1 with ray"),
        ({"executor": "serial", "workers": 2}, "wanted processes or ray"),
        ({"address": "auto"}, "wanted --executor ray as well"),
    ],
)
def test_one_that_contradicts_another_is_refused(options, told) -> None:
    with pytest.raises(ParameterError, match=told):
        Executing(**options)
