"""Pictures of robosuite are of the environment that is asked: on a stand-in, without robosuite."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from sheath_manip.adapters.from_robosuite import RobosuiteMaker
from sheath_manip.adapters.robosuite_gymnasium import RobosuiteGymnasium


class Screen:
    """Stands in for OpenGL: what is drawn is of the context that is current."""

    current: object = None


class Lift:
    """Stands in for robosuite's environment, whose pictures have its own shade of grey."""

    control_timestep, horizon = 0.05, 10
    action_spec = (-np.ones(1), np.ones(1))
    robots = ()

    def __init__(self, screen: Screen, shade: int) -> None:
        self.screen, self.shade = screen, shade
        self.rng = np.random.default_rng(0)
        self._observables = {}
        context = SimpleNamespace(make_current=lambda: setattr(screen, "current", self))
        drawing = SimpleNamespace(gl_ctx=context)
        self.sim = SimpleNamespace(_render_context_offscreen=drawing)
        context.make_current()

    def observation_spec(self):
        return self.reset()

    def reset(self):
        shade = getattr(self.screen.current, "shade", 0)
        return {"front_image": np.full((2, 2, 3), shade, np.uint8)}

    def step(self, _):
        return self.reset(), 0.0, False, {}

    def close(self):
        """Free textures by number, in the context that is current."""
        if isinstance(self.screen.current, Lift):
            self.screen.current.shade = 0

    def _get_observations(self):
        return self.reset()

    def _update_observables(self, force):
        assert force

    def _check_success(self):
        return False


@pytest.mark.parametrize(
    "look",
    [
        lambda env: env.reset(seed=1)[0],
        lambda env: env.step(np.zeros(1))[0],
        lambda env: (env.recall(np.zeros(0)), env._get_obs())[1],
    ],
    ids=["reset", "step", "restored"],
)
def test_another_environment_made_and_closed_does_not_change_the_pictures(look, monkeypatch):
    macros = SimpleNamespace(IMAGE_CONVENTION="opengl")
    monkeypatch.setitem(sys.modules, "robosuite", SimpleNamespace(macros=macros))
    screen = Screen()
    first, second = (RobosuiteGymnasium(Lift(screen, shade)) for shade in (50, 200))
    assert look(first)["front_image"].max() == 50
    assert look(second)["front_image"].max() == 200
    screen.current = None
    assert look(first)["front_image"].max() == 50


def test_what_another_environment_frees_at_its_end_is_its_own(monkeypatch):
    macros = SimpleNamespace(IMAGE_CONVENTION="opengl")
    monkeypatch.setitem(sys.modules, "robosuite", SimpleNamespace(macros=macros))
    screen = Screen()
    first, second = (RobosuiteGymnasium(Lift(screen, shade)) for shade in (50, 200))
    first.reset(seed=1)
    second.close()
    assert first.reset(seed=1)[0]["front_image"].max() == 50


def test_without_a_camera_nothing_is_drawn(monkeypatch):
    macros = SimpleNamespace(IMAGE_CONVENTION="opengl")
    monkeypatch.setitem(sys.modules, "robosuite", SimpleNamespace(macros=macros))
    inner = Lift(Screen(), 50)
    inner.sim._render_context_offscreen = None
    RobosuiteGymnasium(inner).step(np.zeros(1))


class Cube(Lift):
    """Whose cube has another size with every model that is loaded."""

    hard_reset = False

    def __init__(self) -> None:
        super().__init__(Screen(), 50)
        self.rng = np.random.default_rng()
        self._load()

    def _load(self) -> None:
        self.size = self.rng.random(), np.random.random()  # noqa: NPY002

    def reset(self):
        if self.hard_reset:
            self._load()
        return super().reset()


def test_what_is_drawn_for_the_model_is_the_same_wherever_it_is_made(monkeypatch):
    macros = SimpleNamespace(IMAGE_CONVENTION="opengl")
    monkeypatch.setitem(sys.modules, "robosuite", SimpleNamespace(macros=macros))
    first, second = (RobosuiteMaker(Cube, {})().inner for _ in range(2))
    assert first.size == second.size
    assert not first.hard_reset
