"""A gate that was loaded, asked in anybody's loop."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.adapters.from_callable import from_callable
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.learning.frozen_settings import FROZEN
from sheath_manip.learning.gate_file import load_gate
from sheath_manip.types import Actor, Proposal, Reason
from tests import frozen

FAR = [6.0, -6.0]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return frozen.saved(tmp_path)


class TestLoop:
    def test_the_policy_acts_where_it_is_known_and_the_expert_elsewhere(self, path) -> None:
        policy = frozen.policy()
        gate = load_gate(path, policy)
        gate.reset()
        for place, actor in (([0.2, 0.3], Actor.POLICY), (FAR, Actor.EXPERT)):
            seen = frozen.seen(place)
            decision = gate.decide(seen, policy.propose(seen.alone))
            assert decision.actor is actor
            assert gate.fault == ""

    def test_it_fails_safe(self, path: Path) -> None:
        policy = frozen.policy()
        gate, known = load_gate(path, policy), frozen.seen([0.2, 0.3])
        proposal = policy.propose(known.alone)
        assert gate.decide(known, proposal).actor is Actor.POLICY
        latents, nan = proposal.latents, np.full((1, 2), np.nan, np.float32)
        spoiled = {"latent": np.full_like(latents["latent"], np.nan)}
        for wrong, why in (
            (None, ""),
            (replace(proposal, actions=nan), "not finite"),
            (replace(proposal, latents=spoiled), "latents 'latent' are not finite"),
            (Proposal(np.full((1, 2), 7, np.float32), latents), "leaves its bounds"),
            (np.zeros(3), "has shape"),
            ("fast", "no array of real numbers"),
        ):
            decision = gate.decide(known, wrong)
            assert (decision.actor, decision.query) == (Actor.EXPERT, True)
            assert decision.reason is Reason.INVALID_PROPOSAL
            assert why in gate.fault
        for unseen, why in (
            (frozen.seen([np.nan, 0.3]), "not so: x_m"),
            (frozen.seen([0.2]), r"wanted float32 (2,)"),
            (frozen.seen(0.2), r"wanted float32 (2,)"),
            (replace(known, images={"top": np.zeros((2, 2, 3), np.uint8)}), "wanted the cameras"),
            (None, "AttributeError"),
        ):
            decision = gate.decide(unseen, proposal)  # pyright: ignore
            assert (decision.actor, decision.reason) == (Actor.EXPERT, Reason.GATE_FAILED)
            assert why in gate.fault
        # An action alone says nothing of what the policy saw.
        assert gate.decide(known, [0.0, 0.0]).reason is Reason.GATE_FAILED
        assert "reads a latent" in gate.fault
        assert gate.decide(known, proposal).actor is Actor.POLICY
        assert gate.fault == ""

    def test_an_action_does_where_nothing_inside_the_policy_is_read(self, tmp_path) -> None:
        path = frozen.fitted(embed=None).save(tmp_path / "observed.npz")
        gate = load_gate(path, frozen.policy(embed=None))
        place = np.array([0.2, 0.3])
        doubles = replace(frozen.seen(place), features=place, time_s=float("nan"))
        assert gate.decide(doubles, frozen.steered(place)).actor is Actor.POLICY
        assert gate.decide(frozen.seen(place), [1.0, 1.0]).actor is Actor.EXPERT

    def test_a_turn_ends_by_the_time_of_the_observations(self, tmp_path) -> None:
        config = replace(FROZEN, requests=RequestConfig(turn_s=1.0))
        path = frozen.fitted(config, embed=None).save(tmp_path / "limited.npz")
        gate = load_gate(path, frozen.policy(embed=None))
        gate.reset()

        def actor(place: list[float], time_s: float) -> Actor:
            known = replace(frozen.seen(place), time_s=time_s)
            return gate.decide(known, frozen.steered(known.features)).actor

        actors = [actor(FAR if step == 5 else [0.2, 0.2], step / 20) for step in range(50)]
        assert [step for step, each in enumerate(actors) if each is Actor.EXPERT] == list(
            range(5, 25)
        )
        # Where time is no number nobody can say how long a turn lasts.
        assert actor([0.2, 0.2], float("nan")) is Actor.EXPERT
        assert "finite time" in gate.fault

    def test_a_plan_is_void_once_the_expert_acts_and_an_episode_begins_for_both(self, tmp_path):
        begun: list[object] = []
        planned: list[object] = []

        def act(observation):
            planned.append(observation)
            return np.repeat(frozen.steered(observation.features)[None], 5, axis=0)

        policy = from_callable(act, reset=begun.append, action=frozen.SPEC.action)
        made = frozen.fitted(embed=None)
        fitted = replace(made.fitted, policy=policy)
        gate = load_gate(replace(made, fitted=fitted).save(tmp_path / "chunks.npz"), policy)
        gate.reset(seed=3)
        assert len(begun) == 1
        planned.clear()
        for place, plans in (([0.2, 0.2], 1), ([0.2, 0.2], 1), (FAR, 1), ([0.2, 0.2], 2)):
            seen = frozen.seen(place)
            gate.decide(seen, policy.propose(seen.alone))
            assert len(planned) == plans
