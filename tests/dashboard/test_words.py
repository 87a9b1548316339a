"""What the page says in words, without a browser."""

from types import SimpleNamespace

import numpy as np
import pytest

from sheath_manip.burden import StepCounts
from sheath_manip.dashboard.markup import note
from sheath_manip.dashboard.snapshot import snapshot_of
from sheath_manip.dashboard.widgets.learning import LearningCurves
from sheath_manip.dashboard.widgets.score_plot import NO_SCORE, NO_STEP, ScorePlot
from sheath_manip.gates import AlwaysExpert
from sheath_manip.playback.film import Film, film_of
from sheath_manip.playback.labels import score_label
from sheath_manip.rollout import rollout
from sheath_manip.types import EpisodeInfo, Purpose
from tests.experiments.round_results import round_result
from tests.toy import PLAN, Corridor, MiddleKeeper


@pytest.mark.parametrize(
    ("score", "threshold", "said"),
    [
        (0.0219, -0.0021, "score 0.0219 ≥ -0.0021"),
        (-5.5634, -4.2, "score -5.56 < -4.20"),
        (-0.17312, -0.17298, "score -0.17312 < -0.17298"),
        (0.5, 0.0, "score 0.50 ≥ 0.00"),
        (0.0, 0.0, "score 0.00 ≥ 0.00"),
        (1e-9, 2e-9, "score 1e-09 < 2e-09"),
        (-1e6, 0.25, "score -1000000.00 < 0.25"),
    ],
)
def test_a_score_has_the_digits_that_tell_it_from_its_threshold(score, threshold, said):
    assert score_label(score, threshold) == said


def drawn(kind, spec, film, at, results=()) -> list[str]:
    """What a widget has written once it has drawn one step, on a page that nobody serves."""
    written = list[SimpleNamespace]()

    def add(content="", visible=True, **_):
        written.append(SimpleNamespace(content=content, visible=visible))
        return written[-1]

    gui = SimpleNamespace(add_html=add, add_uplot=lambda *_, **__: SimpleNamespace(visible=False))
    snapshot = snapshot_of(
        film,
        at,
        series=StepCounts(),
        outcomes={},
        training=None,
        paused=False,
        present=True,
        results=results,
    )
    kind(SimpleNamespace(viser=SimpleNamespace(gui=gui), spec=spec)).draw(snapshot)
    return [each.content for each in written if each.visible]


@pytest.fixture(scope="module")
def film() -> Film:
    """An episode of a method without a gate."""
    corridor = Corridor()
    info = EpisodeInfo.of(
        corridor.spec, variant="default", seed=3, purpose=Purpose.LEARNING, method="dagger"
    )
    expert = MiddleKeeper(corridor)
    rng = np.random.default_rng(0)
    return film_of(corridor, rollout(corridor, info, AlwaysExpert(), rng=rng, expert=expert))


def test_where_nothing_is_judged_it_says_so_of_the_method(film):
    spec = Corridor().spec
    assert drawn(ScorePlot, spec, film, 2)[1:] == [note(NO_SCORE.format(method="dagger"))]
    before = Film(film.info, (), film.first_pose)
    assert drawn(ScorePlot, spec, before, -1)[1:] == [note(NO_STEP)]


def test_what_round_0_shows_alone_is_the_cloned_policy(film):
    results = [round_result(PLAN, "dagger", 0, number) for number in (0, 1)]
    charts = drawn(LearningCurves, Corridor().spec, film, 2, results)
    named = {
        title: next(line for line in charts if title in line)
        for title in ("Failed while learning", "Policy alone failed", "Expert acted")
    }
    assert "expert</span>" in named["Failed while learning"]
    assert "expert</span>" in named["Expert acted"]
    assert "cloned policy</span>" in named["Policy alone failed"]
    assert "expert</span>" not in named["Policy alone failed"]
    assert all("DAgger</span>" in line for line in named.values())
