"""The benchmark of nu, small, on a toy task."""

import io
import json
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.nu.benchmark import run_nu
from sheath_manip.experiments.nu.plan import PLANS, NuPlan
from sheath_manip.experiments.nu.summary import table
from sheath_manip.experiments.study import Study
from sheath_manip.rollout.executing import Executing
from sheath_manip.tasks.table import STUDIES
from tests.buttons import BUTTONS, PLAN
from tests.experiments.test_figures_generic import assert_shows_something

LEARNING = PLAN.changed(
    comparison={"methods": ("sheath",)},
    gate={"threshold": {"rule": "boundary"}},
    schedule={"variant": "default", "episodes": 3},
)
STUDY = Study(BUTTONS, plans={"nu": LEARNING})
SMALL = NuPlan(nus=(0.05, 0.6))


def benchmark(directory: Path, plan: NuPlan = SMALL) -> dict:
    return run_nu(
        [STUDY, Study(replace(BUTTONS, name="takes-no-part"))],
        plan,
        runs=directory / "runs",
        results=directory / "results",
        command="sheath experiment nu",
        executing=Executing(workers=0),
        console=Console(file=io.StringIO()),
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    directory = tmp_path_factory.mktemp("nu")
    benchmark(directory)
    return directory


def summary_of(directory: Path) -> dict:
    """Without what depends on the time of day: others may commit while this runs."""
    summary = json.loads((directory / "results" / "summary.json").read_text())
    return summary | {"wall_s": None, "git": None}


def test_the_smaller_the_support_the_more_lies_outside(whole):
    summary = summary_of(whole)
    assert set(summary["tasks"]) == {"buttons"}
    wide, narrow = summary["tasks"]["buttons"]["nus"]
    assert (wide["nu"], narrow["nu"]) == SMALL.nus
    assert wide["outside"] < narrow["outside"]
    for row in (wide, narrow):
        assert [entry["round"] for entry in row["rounds"]] == [0, 1, 2]
        assert row["area"]["policy"]["runs"] == 1
        # Nothing but the support decides who acts.
        for entry in row["rounds"][1:]:
            assert entry["expert_share"] == pytest.approx(entry["xi"])


def test_all_nu_have_the_same_demonstrations(whole):
    names = [
        sorted(path.name for path in (whole / "runs" / "buttons").glob(f"{nu}/store/demo*"))
        for nu in ("nu-0.05", "nu-0.6")
    ]
    assert len(names[0]) == 2
    assert names[0] == names[1]


def test_the_figure_shows_something_and_the_table_fits(whole, capsys):
    assert_shows_something(whole / "results" / summary_of(whole)["talk"])
    Console(width=80).print(table(summary_of(whole)))
    assert "…" not in capsys.readouterr().out


def test_resumed_it_gives_the_same_summary_and_more_nu_may_join(whole):
    before = summary_of(whole)
    round_file = whole / "runs" / "buttons" / "nu-0.6" / "s0" / "sheath" / "round-02.json"
    round_file.unlink()
    benchmark(whole)
    assert summary_of(whole) == before
    more = benchmark(whole, replace(SMALL, nus=(0.05, 0.2, 0.6)))["tasks"]["buttons"]["nus"]
    assert [more[0], more[2]] == before["tasks"]["buttons"]["nus"]


def test_a_plan_that_no_task_has_is_one_line(tmp_path):
    with pytest.raises(ParameterError, match="no task has a plan 'other'"):
        benchmark(tmp_path, NuPlan(learning="other"))
    with pytest.raises(ParameterError, match=r"nus are \(0\.0,\)"):
        NuPlan(nus=(0.0,))


@pytest.mark.parametrize("size", PLANS)
def test_the_tasks_plans_look_at_the_support_alone(size):
    plans = [
        study.plans[PLANS[size].learning]
        for study in STUDIES.values()
        if PLANS[size].learning in study.plans
    ]
    assert len(plans) >= 2
    for plan in plans:
        assert (plan.gate.signal, plan.gate.threshold.rule) == ("support", "boundary")
        assert (plan.gate.release_rate, plan.gate.release_margin) == (0, 0)
