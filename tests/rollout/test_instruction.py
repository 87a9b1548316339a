"""What the robot is told to do: shown to the policy, and kept where a task says it in words."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.adapters.from_callable import from_callable
from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.header import header_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import AttemptError
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.types import Action, Observation, Observations, Transition
from tests.rollout.corridor_episode import run
from tests.toy import CHOICES, Corridor


class Told(Corridor):
    """The corridor, in words."""

    words: object = "keep to the middle"

    def reset(self, seed: int) -> Observation:
        return replace(super().reset(seed), instruction=self.words)  # pyright: ignore

    def step(self, action: Action) -> Transition:
        transition = super().step(action)
        told = replace(transition.observation, instruction=self.words)  # pyright: ignore
        return replace(transition, observation=told)


def test_a_policy_is_shown_it_and_the_episode_keeps_it(tmp_path) -> None:
    shown: set[str] = set()

    def act(observation: Observation) -> Action:
        shown.add(observation.instruction)
        return CHOICES[1]

    episode = run(AlwaysPolicy(), from_callable(act), environment=Told())
    assert shown == {"keep to the middle"}
    store = EpisodeStore.create(tmp_path / "store")
    read = store.read(store.append(episode))
    assert {step.observation.instruction for step in read.steps} == shown
    assert read.final_observation.instruction == "keep to the middle"


def test_where_nothing_is_said_a_header_is_as_it_always_was() -> None:
    episode = run(AlwaysPolicy(), from_callable(lambda _: CHOICES[1]))
    assert "instruction" not in to_attributes(header_of(episode))
    told = run(AlwaysPolicy(), from_callable(lambda _: CHOICES[1]), environment=Told())
    assert to_attributes(header_of(told))["instruction"] == "keep to the middle"


def test_in_a_batch_there_are_as_many_as_states_or_none() -> None:
    assert Observation({}, np.zeros(1, np.float32), 0.0).alone.instructions is None
    several = Observations({}, np.zeros((3, 1), np.float32), ("a", "b", "c"))
    assert several.rows(slice(1, 3)).instructions == ("b", "c")
    assert Observations({}, np.zeros((3, 1), np.float32)).rows(slice(1, 3)).instructions is None


@pytest.mark.parametrize("words", [3, None, b"left"])
def test_what_is_no_text_is_no_observation(words: object) -> None:
    environment = Told()
    environment.words = words
    with pytest.raises(AttemptError, match="instruction: wanted a text, got"):
        run(AlwaysPolicy(), from_callable(lambda _: CHOICES[1]), environment=environment)
