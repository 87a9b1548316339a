"""Which stages the platformer's runs are on."""

import numpy as np

from sheath_manip.learning.methods import method_named
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.entry import DRAWN, PLATFORMER, make_stage_of, stage_number
from sheath_manip.tasks.platformer.study.entry import STUDY
from sheath_manip.tasks.platformer.task import PlatformerTask


def test_every_run_has_a_stage_of_its_own_and_no_reset_draws_it():
    runs = [stage_number("run", seed) for seed in range(2000)]
    tuning = [stage_number("tuning", seed) for seed in range(2000)]
    assert len({*runs, *tuning}) == 4000
    assert min(*runs, *tuning) >= DRAWN
    # What NumPy takes for a seed of a stage.
    assert max(*runs, *tuning) < 2**32
    assert stage_number("run", 3) == stage_number("run", 3)


def heights(environment: ComposerEnvironment) -> np.ndarray:
    assert isinstance(environment.task, PlatformerTask)
    return environment.task.stage.heights


def test_the_episodes_of_a_run_share_its_stage_and_nothing_else():
    environment = make_stage_of("run", 1)
    stages, states = [], []
    for seed in (5, 6):
        environment.reset(seed)
        stages.append(heights(environment))
        states.append(environment.state())
    environment.close()
    np.testing.assert_array_equal(*stages)
    assert not np.array_equal(states[0], states[1])
    other = make_stage_of("run", 2)
    other.reset(5)
    assert not np.array_equal(heights(other), stages[0])
    other.close()


def test_the_plans_name_known_variants_and_methods():
    for plan in STUDY.plans.values():
        for variant in (plan.schedule.variant, plan.comparison.final_variant):
            assert variant in {**PLATFORMER.variants, **PLATFORMER.run_variants}
        for name in plan.comparison.methods:
            followed = method_named(name).burden_from
            assert followed is None or followed in plan.comparison.methods
    assert len(STUDY.plans["full"].comparison.seeds) == 50
