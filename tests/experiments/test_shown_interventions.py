from dataclasses import replace

import pytest

from sheath_manip.experiments.figures import View
from sheath_manip.experiments.figures.intervention import best_intervention
from tests.toy import CORRIDOR


def test_the_best_intervention_succeeds_between_steps_of_the_policy(store):
    best = best_intervention(store)
    assert (best.episode.info.index, best.start, best.stop) == (2, 20, 29)
    assert best.expert_s == pytest.approx(0.8)
    assert best.window == slice(14, 35)
    assert best.episode.steps[0].observation.images["top"].shape == (40, 40, 3)


def test_what_differs_within_the_tolerance_is_no_disagreement(store):
    episode = best_intervention(store).episode
    spec = CORRIDOR.make("default").spec.action
    step = replace(episode.steps[0], proposed=spec.maximum)
    off = spec.maximum - 0.05 * (spec.maximum - spec.minimum)
    near = replace(episode, steps=(replace(step, labelled=off), replace(step, proposed=None)))
    assert View().disagreed(near).tolist() == [True, False]
    assert View(action=replace(spec, tolerance=0.1)).disagreed(near).tolist() == [False, False]
    assert View(action=replace(spec, tolerance=0.01)).disagreed(near).tolist() == [True, False]
