import pickle
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces

from sheath_manip.adapters.from_gymnasium import from_gymnasium
from sheath_manip.adapters.judging import Moment
from sheath_manip.adapters.observation_space import ObservationLayout
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import AlwaysExpert
from sheath_manip.playback.film import film_of
from sheath_manip.protocols import Restorable, Viewable, require_restorable
from sheath_manip.rollout import rollout
from sheath_manip.testing import check_task
from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose


class Reach(gymnasium.Env):
    """A point goes to a goal, seen by name, by number and by a picture."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012
    render_mode = "rgb_array"
    action_space = spaces.Box(-np.inf, np.inf, (2,), np.float32)
    observation_space = spaces.Dict(
        {
            "achieved_goal": spaces.Box(-2, 2, (2,)),
            "inner": spaces.Dict({"goal": spaces.Box(-2, 2, (2,)), "mode": spaces.Discrete(3)}),
            "eye": spaces.Box(0, 255, (8, 12, 3), np.uint8),
            "chw": spaces.Box(0, 255, (3, 8, 12), np.uint8),
        }
    )

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed, options=options)
        self.at, self.goal = self.np_random.uniform(-1, 1, (2, 2))
        return self.seen(), {}

    def step(self, action):
        self.at = self.at + 0.1 * np.clip(action, -1, 1)
        near = np.linalg.norm(self.at - self.goal) < 0.2
        return self.seen(), -1.0, bool(np.abs(self.at).max() > 2), False, {"is_success": near}

    def seen(self):
        eye = np.zeros((8, 12, 3), np.uint8)
        eye[3, 5] = 255
        inner = {"goal": self.goal, "mode": 1}
        return {"achieved_goal": self.at, "inner": inner, "eye": eye, "chw": eye.transpose(2, 0, 1)}

    def render(self):
        return np.full((16, 24, 3), 7, np.uint8)


def to_goal(seen):
    return 10 * (seen["inner"]["goal"] - seen["achieved_goal"])


def save(reach):
    return np.concatenate([reach.at, reach.goal])


def load(reach, state):
    reach.at, reach.goal = np.split(state, 2)
    return reach.seen()


OPTIONS = {"name": "reach", "expert": to_goal, "bounds": (-1, 1), "max_steps": 40}
REACH = from_gymnasium(Reach, **OPTIONS)


class Still:
    """An expert that remembers how often it was asked."""

    def __init__(self, environment):
        self.size = environment.action_space.shape

    def reset(self):
        self.asked = 0

    def act(self, _):
        self.asked += 1
        return np.zeros(self.size)


def push_right(_):
    return 1


def by_cart(moment: Moment) -> Outcome:
    return Outcome.FAILURE if moment.terminated else Outcome.TIME_LIMIT


def driven(task, seed=3) -> Episode:
    environment = task.make()
    info = EpisodeInfo.of(
        environment.spec, variant="default", seed=seed, purpose=Purpose.DEMONSTRATION
    )
    expert, rng = task.make_expert(environment), np.random.default_rng(0)
    try:
        return rollout(environment, info, AlwaysExpert(), rng=rng, expert=expert)
    finally:
        environment.close()


@pytest.mark.parametrize(
    "task",
    [
        REACH,
        from_gymnasium(Reach, **OPTIONS, memory=(save, load), success_steps=3, rest=0.0),
        from_gymnasium("CartPole-v1", expert=push_right, judge=by_cart),
        from_gymnasium("Pendulum-v1", expert=Still, metric="return", rest=0.0),
        from_gymnasium("InvertedPendulum-v5", expert=Still, tool="pole"),
    ],
    ids=lambda task: task.name,
)
def test_a_task_of_gymnasium_keeps_the_contract(task) -> None:
    check_task(task)


def test_what_is_seen_stands_by_key_and_name() -> None:
    task = from_gymnasium(
        Reach, **OPTIONS, render="view", feature_names={"inner.goal": ("goal_x_m", "goal_y_m")}
    )
    environment = task.make()
    spec, seen = environment.spec, environment.reset(1)
    assert spec.cameras == {"eye": (8, 12), "chw": (8, 12), "view": (16, 24)}
    assert spec.feature_names == (
        *("achieved_goal_0", "achieved_goal_1", "goal_x_m", "goal_y_m"),
        "inner.mode_0",
    )
    np.testing.assert_array_equal(seen.images["eye"], seen.images["chw"])
    assert seen.images["eye"][3, 5].tolist() == [255] * 3
    assert seen.features[4] == 1
    assert environment.spec.control_rate_hz == 10


def test_an_episode_ends_as_its_info_says() -> None:
    episode = driven(REACH)
    assert episode.outcome is Outcome.SUCCESS
    assert episode.terminated
    assert episode.metrics == {"success": 1.0, "return": -len(episode)}
    longer = driven(from_gymnasium(Reach, **OPTIONS, success_steps=4))
    assert len(longer) == len(episode) + 3
    # A success that has not lasted when the time is over.
    cut = driven(from_gymnasium(Reach, **{**OPTIONS, "max_steps": len(episode)}, success_steps=4))
    assert (cut.outcome, cut.truncated, len(cut)) == (Outcome.TIME_LIMIT, True, len(episode))
    away = driven(from_gymnasium(Reach, **{**OPTIONS, "expert": push_right_for_ever}))
    assert away.outcome is Outcome.FAILURE
    late = driven(from_gymnasium(Reach, **{**OPTIONS, "max_steps": 2}))
    assert (late.outcome, late.truncated, len(late)) == (Outcome.TIME_LIMIT, True, 2)


def push_right_for_ever(seen):
    return [1.0, 0.0] if seen["achieved_goal"][1] > 0 else [1.0, -1.0]


def test_what_cannot_be_restored_is_recorded_without_a_state_and_shown_by_its_cameras() -> None:
    episode = driven(REACH)
    assert {step.state.shape for step in episode.steps} == {(0,)}
    environment = REACH.make()
    assert not isinstance(environment, Restorable | Viewable)
    film = film_of(environment, episode)
    assert "GymnasiumEnvironment has no scene()" in film.lacks
    assert len(film) == len(episode)
    assert film.poses[0].bodies.shape == (0, 7)
    with pytest.raises(ParameterError, match=r"has no state\(\) and restore\(\)"):
        require_restorable(environment, "probes")


def test_a_mujoco_environment_goes_on_from_a_state_to_the_bit_and_is_shown() -> None:
    task = from_gymnasium("InvertedPendulum-v5", expert=Still, tool="pole")
    environment = task.make()
    assert isinstance(environment, Restorable)
    assert isinstance(environment, Viewable)
    rng = np.random.default_rng(0)
    actions = rng.uniform(-3, 3, (8, 1)).astype(np.float32)

    def gone_on() -> list:
        return [environment.step(action).observation.features for action in actions]

    environment.reset(2)
    environment.step(actions[0])
    state, pose = environment.state(), environment.pose()
    first = gone_on()
    environment.reset(2)
    environment.restore(state)
    np.testing.assert_array_equal(gone_on(), first)
    assert {geom.shape for geom in environment.scene()} == {"capsule"}
    again = environment.pose_at(state)
    np.testing.assert_array_equal(again.bodies, pose.bodies)
    assert again.tool_m is not None
    film = film_of(environment, driven(task))
    assert not film.lacks
    assert film.scene
    environment.close()


def test_wrappers_see_and_count_as_they_did() -> None:
    def doubled(seen):
        return 2 * seen

    def made():
        made = gymnasium.make("InvertedPendulum-v5")
        return gymnasium.wrappers.TransformObservation(made, doubled, made.observation_space)

    environment = from_gymnasium(made, name="doubled", max_steps=4).make()
    environment.reset(0)
    assert isinstance(environment, Restorable)
    action = np.zeros(1, np.float32)
    seen = environment.step(action).observation
    state = environment.state()
    ends = [environment.step(action).truncated for _ in range(3)]
    np.testing.assert_array_equal(environment.restore(state).features, seen.features)
    assert [environment.step(action).truncated for _ in range(3)] == ends == [False, False, True]


def test_an_expert_that_remembers_forgets_at_the_reset() -> None:
    task = from_gymnasium("Pendulum-v1", expert=Still, max_steps=3)
    environment = task.make()
    expert = task.make_expert(environment)
    for _ in range(2):
        seen = environment.reset(0)
        expert.reset()
        expert.act(seen)
    assert expert._expert.asked == 1  # pyright: ignore[reportAttributeAccessIssue]


def test_a_task_can_be_pickled() -> None:
    again = pickle.loads(pickle.dumps(REACH))
    assert again.make().spec.name == "reach"
    assert replace(again, summary="").variants.keys() == REACH.variants.keys()


@pytest.mark.parametrize(
    ("said", "make", "options"),
    [
        ("infinite bounds; wanted bounds=", Reach, {"bounds": None}),
        ("wanted max_steps=", Reach, {"max_steps": None}),
        ("no observation 'eyes'", Reach, {"leave_out": ["eyes"]}),
        ("1 feature names of observation", Reach, {"feature_names": {"achieved_goal": ("x_m",)}}),
        ("cannot make 'Nonesuch-v0'", "Nonesuch-v0", {}),
        ("wants a name=", Reach, {"name": ""}),
        ("has no expert", Reach, {"expert": None}),
    ],
)
def test_what_cannot_be_taken_is_said_in_a_line(said, make, options) -> None:
    with pytest.raises(ParameterError, match=said) as raised:
        driven(from_gymnasium(make, **{**OPTIONS, **options}))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    "space", [spaces.Box(0, 1, (3, 64, 64)), spaces.Text(4), spaces.Box(0, 1, (40, 40))]
)
def test_a_space_that_is_neither_image_nor_numbers_is_refused(space) -> None:
    with pytest.raises(ParameterError, match="taken are images of uint8"):
        ObservationLayout.of(space, {})
