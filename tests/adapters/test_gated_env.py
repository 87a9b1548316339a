"""A gate around somebody else's loop: the same steps as the one loop's, and as safe."""

import gymnasium
import numpy as np
import pytest

from sheath_manip.adapters.from_gymnasium import from_gymnasium
from sheath_manip.adapters.gated_env import METHOD, GatedEnv
from sheath_manip.adapters.to_gymnasium import to_gymnasium
from sheath_manip.exceptions import AttemptError, ParameterError, UnknownNameError
from sheath_manip.rollout import rollout
from sheath_manip.seeding import generator
from sheath_manip.types import Actor, EpisodeInfo, GateDecision, Proposal, Purpose, Reason
from tests.adapters.corridor_gate import checkpoint, looking_checkpoint
from tests.guest_package.guest.slide import SLIDE
from tests.toy import CORRIDOR, Corridor, MiddleKeeper


class Says:
    """A gate that says what it is told, or raises it."""

    def __init__(self, *said):
        self.said = said
        self.asked = []

    def reset(self, rng):
        del rng
        self.asked.clear()

    def decide(self, observation, proposal):
        del observation
        self.asked.append(proposal)
        said = self.said[(len(self.asked) - 1) % len(self.said)]
        if isinstance(said, Exception):
            raise said
        return said


FLAT = np.zeros(3, np.float32)
POLICY = GateDecision(Actor.POLICY, False, Reason.INSIDE, 1.5, 0.5)
EXPERT = GateDecision(Actor.EXPERT, True, Reason.OUTSIDE, 0.25, 0.5)
LABEL = GateDecision(Actor.POLICY, True, Reason.INSIDE, 1.5, 0.5)


def gated(gate, task=CORRIDOR, **options) -> GatedEnv:
    return GatedEnv(to_gymnasium(task), gate, **options)


def test_the_gate_judges_what_is_stepped_and_the_info_says_what_came_of_it():
    env = gated(Says(POLICY, EXPERT, LABEL))
    env.reset(seed=4)
    told = []
    for _ in range(3):
        wanted = env.task_env.expert()
        _, _, _, _, info = env.step(0)
        told.append((info, wanted))
    (first, _), (second, by_expert), (third, label) = told
    assert (first["actor"], first["reason"]) == ("policy", "inside support")
    assert (first["proposed"], first["requested"], first["executed"]) == (0, 0, 0)
    assert (first["labelled"], first["score"], first["threshold"]) == (None, 1.5, 0.5)
    assert (second["actor"], second["proposed"]) == ("expert", 0)
    assert {second["requested"], second["executed"], second["labelled"]} == {by_expert}
    assert (third["actor"], third["executed"], third["labelled"]) == ("policy", 0, label)
    assert first["outcome"] == "time-limit"
    assert all(info["broken"] == [] for info, _ in told)


@pytest.mark.parametrize("made", [checkpoint, looking_checkpoint])
def test_it_takes_the_same_steps_as_the_one_loop(made):
    found = made()
    environment = Corridor()
    seed = 11
    info = EpisodeInfo.of(
        environment.spec, variant="default", seed=seed, purpose=Purpose.LEARNING, method=METHOD
    )
    episode = rollout(
        environment,
        info,
        found.gate(),
        rng=generator(METHOD, seed),
        policy=found.policy,
        expert=MiddleKeeper(environment),
    )
    env = gated(found)
    seen, told = env.reset(seed=seed)
    for step in episode.steps:
        proposed = found.policy.propose(env.task_env.present.alone)
        seen, reward, _, _, told = env.step(env.task_env.spaces.shown(proposed.now[0]))
        assert told["actor"] == step.decision.actor
        assert told["score"] == pytest.approx(step.decision.score, nan_ok=True, abs=1e-12)
        assert (told["threshold"], reward) == (step.decision.threshold, step.reward)
        assert env.task_env.spaces.taken(told["executed"]) == step.executed
    assert len({step.decision.actor for step in episode.steps}) == 2
    assert np.array_equal(seen["features"], episode.final_observation.features)
    assert (told["outcome"], told["metrics"]) == (str(episode.outcome), episode.metrics)


def test_a_gate_is_taken_from_a_file_a_checkpoint_or_what_was_fitted(tmp_path):
    found = checkpoint()
    made = (found.save(tmp_path / "c.npz"), str(tmp_path / "c.npz"), found, found.fitted)
    scores = set()
    for gate in made:
        env = gated(gate)
        env.reset(seed=2)
        scores.add(env.step(1)[4]["score"])
    assert len(scores) == 1
    assert np.isfinite(scores.pop())


def test_latents_come_with_a_proposal_or_from_the_policy_that_the_gate_was_fitted_around():
    found = looking_checkpoint()
    env = gated(found)
    bare = GatedEnv(to_gymnasium(CORRIDOR), found.gate())
    env.reset(seed=2)
    bare.reset(seed=2)
    look = found.policy.propose(env.task_env.present.alone)
    # The action that is judged is the learner's, no matter who looked.
    action = np.array([[0.3]], np.float32)
    by_hand = bare.step(Proposal(action, look.latents))[4]
    told = env.step(2)[4]
    assert told["proposed"] == by_hand["proposed"] == 2
    assert told["score"] == by_hand["score"]
    # A gate whose kind is not known here is not tried before: a bare action it cannot judge.
    told = bare.step(2)[4]
    assert (told["actor"], told["reason"]) == ("expert", "gate failed")
    assert told["broken"] == ["gate: ParameterError"]


def test_what_cannot_work_is_a_line():
    wanted = "wanted that of to_gymnasium\\(from_gymnasium"
    with pytest.raises(ParameterError, match=f"not CartPoleEnv; {wanted}"):
        GatedEnv(gymnasium.make("CartPole-v1"), checkpoint())
    with pytest.raises(ParameterError, match="a gate of type int; wanted a file, a Checkpoint"):
        gated(3)
    with pytest.raises(ParameterError, match="the checkpoint is of the task 'corridor'"):
        gated(checkpoint(), SLIDE)
    with pytest.raises(ParameterError, match="the gate cannot judge what that policy sees: the"):
        gated(looking_checkpoint(), looks=checkpoint().policy)
    with pytest.raises(UnknownNameError, match="unknown expert of corridor 'nobody'"):
        gated(checkpoint(), expert="nobody")
    scaled = gymnasium.wrappers.RescaleAction(to_gymnasium(SLIDE), np.float32(-2), np.float32(2))
    with pytest.raises(ParameterError, match="put such wrappers around GatedEnv"):
        GatedEnv(scaled, Says(POLICY))
    env = gated(Says(POLICY))
    with pytest.raises(ParameterError, match="no episode is under way"):
        env.step(0)


@pytest.mark.parametrize("rubbish", [7, None, "left", np.array([np.nan]), Proposal(FLAT)])
def test_in_place_of_what_is_no_action_the_expert_acts(rubbish):
    env = gated(Says(POLICY))
    env.reset(seed=0)
    wanted = env.task_env.expert()
    told = env.step(rubbish)[4]
    assert (told["actor"], told["reason"]) == ("expert", "invalid proposal")
    assert (told["proposed"], told["executed"]) == (None, wanted)


@pytest.mark.parametrize("said", [ValueError("no"), "let it", None])
def test_in_place_of_a_gate_that_fails_the_expert_acts(said):
    env = gated(Says(said))
    env.reset(seed=0)
    told = env.step(0)[4]
    assert (told["actor"], told["reason"]) == ("expert", "gate failed")


def test_where_nobody_is_left_the_episode_ends_in_a_line():
    class Lost(MiddleKeeper):
        def act(self, observation):
            raise RuntimeError(f"lost at {observation.time_s}")

    env = gated(Says(EXPERT), expert=Lost(Corridor()))
    env.reset(seed=0)
    with pytest.raises(AttemptError, match=r"the expert broke down \(RuntimeError: lost at"):
        env.step(0)
    with pytest.raises(ParameterError, match="no episode is under way"):
        env.step(0)
    env.reset(seed=1)


def test_another_controller_of_the_task_is_named_in_the_experts_place():
    env = gated(Says(EXPERT), expert="hold")
    env.reset(seed=0)
    assert env.step(0)[4]["executed"] == 1


def test_wrappers_in_between_have_their_say():
    inner = gymnasium.wrappers.TimeLimit(to_gymnasium(CORRIDOR), 3)
    tenfold = gymnasium.wrappers.TransformReward(inner, lambda reward: 10 * float(reward))
    env = GatedEnv(tenfold, Says(POLICY))
    env.reset(seed=0)
    steps = [env.step(1) for _ in range(3)]
    assert {step[1] for step in steps} == {10.0}
    assert [step[3] for step in steps] == [False, False, True]
    with pytest.raises(ParameterError, match="no episode is under way"):
        env.step(1)


def lean(seen) -> int:
    """What keeps a pole upright for a while: push to where it falls."""
    return int(seen[2] + 0.2 * seen[3] > 0)


def test_an_environment_of_another_package_comes_in_and_goes_out_again():
    task = from_gymnasium("CartPole-v1", expert=lean, control_rate_hz=50)
    env, plain = GatedEnv(to_gymnasium(task), Says(POLICY, EXPERT)), gymnasium.make("CartPole-v1")
    seen, _ = env.reset(seed=6)
    wanted, _ = plain.reset(seed=6)
    for step in range(10):
        assert np.array_equal(seen, wanted)
        by_expert = lean(wanted)
        seen, _, _, _, told = env.step(0)
        assert told["executed"] == (by_expert if step % 2 else 0)
        wanted, *_ = plain.step(told["executed"])


def test_scenes_are_those_of_the_environment_inside():
    env, plain = gated(Says(POLICY)), to_gymnasium(CORRIDOR)
    for seed in (9, None, None):
        assert env.reset(seed=seed)[1]["scene"] == plain.reset(seed=seed)[1]["scene"]
