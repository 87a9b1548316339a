from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from sheath_manip.experiments.figures import View
from sheath_manip.experiments.figures.intervention import best_intervention
from tests.toy import CORRIDOR

film_strip = import_module("sheath_manip.experiments.figures.film_strip")
"""the module, whose name in the package is the function"""


def test_the_best_intervention_succeeds_between_steps_of_the_policy(store):
    best = best_intervention(store)
    assert (best.episode.info.index, best.start, best.stop) == (2, 20, 29)
    assert best.expert_s == pytest.approx(0.8)
    assert best.window == slice(14, 35)
    assert best.episode.steps[0].observation.images["top"].shape == (40, 40, 3)


@pytest.mark.parametrize("always", [False, True])
def test_what_differs_at_every_step_is_said_and_not_drawn(store, tmp_path, monkeypatch, always):
    figures, words = [], []
    monkeypatch.setattr(
        film_strip,
        "heading",
        lambda figure, *said: (figures.append(figure), words.append(said[1])),
    )
    best = best_intervention(store)
    differ = np.zeros(len(best.episode), bool)
    differ[best.start : len(differ) if always else best.stop] = True
    differ[: best.start] = always
    monkeypatch.setattr(View, "disagreed", lambda *_: differ)
    film_strip.film_strip(best, tmp_path / "strip.png")
    labels = [text.get_text() for legend in legends_of(figures[0]) for text in legend.get_texts()]
    assert any("want different actions" in label for label in labels) is not always
    assert ("want different actions in 21 of 21 steps" in words[0]) is always


def legends_of(figure: Figure) -> list[Legend]:
    inner = [legend for part in figure.subfigs for legend in part.legends]
    return [*figure.legends, *inner]


def test_what_differs_within_the_tolerance_is_no_disagreement(store):
    episode = best_intervention(store).episode
    spec = CORRIDOR.make("default").spec.action
    step = replace(episode.steps[0], proposed=spec.maximum)
    off = spec.maximum - 0.05 * (spec.maximum - spec.minimum)
    near = replace(episode, steps=(replace(step, labelled=off), replace(step, proposed=None)))
    assert View().disagreed(near).tolist() == [True, False]
    assert View(action=replace(spec, tolerance=0.1)).disagreed(near).tolist() == [False, False]
    assert View(action=replace(spec, tolerance=0.01)).disagreed(near).tolist() == [True, False]
