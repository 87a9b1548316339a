"""A program that has nothing but the page's websocket grasps and drives; a policy learns of it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, PersonGate, beside_the_policy
from sheath_manip.dashboard import Dashboard
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates import SupportGate
from sheath_manip.policies import make_policy
from sheath_manip.rollout.loop import rollout
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.tasks.driving.task import DrivingTask
from sheath_manip.tasks.driving.task import Scenario as DrivingScenario
from sheath_manip.tasks.gauze_cutting.entry import GAUZE_CUTTING
from sheath_manip.tasks.gauze_cutting.scenario import Scenario as GauzeScenario
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER
from sheath_manip.tasks.grasp_clutter.scene import EASY
from sheath_manip.tasks.grasp_clutter.task import GraspTask
from sheath_manip.tasks.grasp_clutter.task import Scenario as GraspScenario
from sheath_manip.types import (
    Action,
    Actor,
    Episode,
    EpisodeInfo,
    Observation,
    Outcome,
    Purpose,
    Reason,
)
from sheath_manip.types.samples import samples_from
from tests.judging import ByObservation
from tools.scripted_person import (
    Absent,
    Held,
    ScriptedPerson,
    at_the_wheel,
    on_four_keys,
    on_the_sticks,
)
from tools.station import Station

CALM_STEPS = 4
"""in which the gate lets the policy act, before it asks for the person"""


def operated_episode(
    task: Task,
    inner: ComposerEnvironment,
    in_its_hands: Callable[[Action], Held],
    store: EpisodeStore,
    seed: int,
) -> Episode:
    """A policy that does nothing, a gate that soon asks for a person, and a program that comes."""
    assert task.teleop is not None
    by_hand = task.teleop(inner)
    cockpit = Cockpit(by_hand.guide)
    can_hold = "hold" in task.fallbacks
    scripted = task.expert(inner)
    stand_in = task.make_expert(inner, "hold") if can_hold else scripted
    spec = inner.spec
    calm_s = CALM_STEPS / spec.control_rate_hz

    def score(observation: Observation) -> float:
        return 1.0 if observation.time_s < calm_s - 1e-6 else -1.0

    rest = getattr(stand_in, "_rest", lambda: np.zeros(len(spec.action.names), np.float32))
    with (
        Dashboard(spec, port=0, cockpit=cockpit) as page,
        Station(page.address) as station,
    ):
        person = ScriptedPerson(station, task.expert(inner), in_its_hands, cockpit)
        episode = rollout(
            OperatedEnvironment(inner, cockpit),
            EpisodeInfo(spec.name, seed, Purpose.LEARNING, spec.control_rate_hz, "person"),
            PersonGate(
                SupportGate(ByObservation(score), 0.0),
                cockpit,
                spec.control_rate_hz,
                # A car cannot wait: the scripted expert bridges the one step until it is there.
                wait_s=60.0 if can_hold else 0.0,
                can_hold=can_hold,
                dead_man=by_hand.dead_man,
                fallback_teaches=False,
                # It looks after each step, so there must be one while the robot waits for it.
                stands_still=False,
            ),
            rng=np.random.default_rng(0),
            policy=Absent(rest),
            others=beside_the_policy(cockpit, by_hand, hold=stand_in, fallback=stand_in),
            listeners=(page, person, Recorder(store)),
        )
    assert person.took_over == 1
    return episode


def assert_recorded(store: EpisodeStore, episode: Episode) -> Episode:
    """The stored episode, whose interventions are the person's and labelled by it."""
    name = next(iter(store.names()))
    recorded = store.recorded(name).arrays
    read = store.read(name)
    acted = np.array([step.decision.actor is not Actor.POLICY for step in read.steps])
    assert not acted[:CALM_STEPS].any()
    assert acted[CALM_STEPS:].all()
    np.testing.assert_array_equal(recorded["intervention"], acted)
    by_person = [step for step in read.steps if step.decision.actor is Actor.OPERATOR]
    assert {step.decision.reason for step in by_person} == {Reason.PERSON}
    assert len(by_person) > 0.9 * (len(episode) - CALM_STEPS)
    assert all(step.label is not None for step in by_person)
    assert sum(step.label is not None for step in read.steps) == len(by_person)
    return read


def test_a_grasp_from_which_a_policy_learns(tmp_path: Path):
    inner = ComposerEnvironment(GraspTask(GraspScenario(difficulty=EASY, cameras=("wrist",))))
    store = EpisodeStore.create(tmp_path / "store")
    episode = operated_episode(GRASP_CLUTTER, inner, on_the_sticks, store, seed=5)
    assert episode.outcome is Outcome.SUCCESS
    assert any(step.limited for step in episode.steps)
    states = samples_from([assert_recorded(store, episode)])

    def squared_error(steps: int) -> float:
        policy = make_policy("spatial-cnn", inner.spec, seed=0, steps=steps, batch_size=32)
        predicted = policy.fit(states).predict(states.observations)
        return float(((predicted.now - states.labels) ** 2).mean())

    learned = squared_error(steps=80)
    assert learned < 0.2 * squared_error(steps=0)
    # Nor is it the mean action, whatever is seen.
    assert learned < 0.4 * states.labels.var(axis=0).mean()
    inner.close()


@pytest.mark.soak
def test_a_disc_is_cut_out_by_four_keys(tmp_path: Path):
    inner = ComposerEnvironment(GauzeTask(GauzeScenario(cameras=())))
    store = EpisodeStore.create(tmp_path / "store")
    episode = operated_episode(GAUZE_CUTTING, inner, on_four_keys, store, seed=20)
    assert episode.outcome is Outcome.SUCCESS
    assert episode.metrics["deviation_mm"] < 1.0
    assert_recorded(store, episode)
    inner.close()


@pytest.mark.soak
def test_a_lap_from_which_a_policy_learns(tmp_path: Path):
    inner = ComposerEnvironment(DrivingTask(DrivingScenario()))
    store = EpisodeStore.create(tmp_path / "store")
    episode = operated_episode(DRIVING, inner, at_the_wheel, store, seed=5)
    assert episode.outcome is Outcome.SUCCESS
    assert episode.metrics["laps"] == 1.0
    states = samples_from([assert_recorded(store, episode)])
    policy = make_policy("hog-svm", inner.spec, seed=0).fit(states)
    predicted = policy.predict(states.observations).now
    right = (np.abs(predicted - states.labels) < 1e-3).mean()
    most = max((states.labels == choice).mean() for choice in np.unique(states.labels))
    assert right > most + 0.1
    inner.close()
