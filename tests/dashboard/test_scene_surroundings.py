"""What the page makes of a scene: planes that light falls on, a floor, a policy's camera."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.following import Following
from sheath_manip.dashboard.scene import SLAB_M, plain, upwards
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.dashboard.widgets.floor import Floor
from sheath_manip.dashboard.widgets.look_through import FREE, LookThrough
from sheath_manip.types import CameraPose, SceneGeom, ScenePose
from tests.dashboard.conftest import SPEC

TABLE = SceneGeom(
    body=1,
    shape="picture",
    size=np.array([0.4, 0.5, 0.05]),
    rgba=(0.2, 0.4, 0.6, 1.0),
    position_in_body=np.array([0.0, 0.0, 0.5]),
    wxyz_in_body=np.array([1.0, 0.0, 0.0, 0.0]),
    picture=np.array([[[51, 102, 153]]], np.uint8),
)
STANDING = np.array([[0.0, 0, 0, 1, 0, 0, 0], [0.5, 0, 0, 1, 0, 0, 0]])


def shown(*geoms: SceneGeom, **pose: object) -> SimpleNamespace:
    return SimpleNamespace(scene=geoms, pose=replace(ScenePose(STANDING), **pose))


def test_a_plane_of_one_colour_is_no_picture():
    assert plain(TABLE) == (51, 102, 153)
    assert plain(replace(TABLE, picture=np.zeros((2, 3, 3), np.uint8))) is None
    assert plain(replace(TABLE, shape="box", picture=None)) is None
    # Stood on its side, by a quarter turn about x.
    assert upwards(np.array([0.5**0.5, 0.5**0.5, 0.0, 0.0])) == pytest.approx([0, -1, 0])


def test_a_floor_lies_right_below_the_plane_that_things_stand_on(dashboard: Dashboard):
    server = dashboard._server.viser
    floor = Floor(WidgetContext(server, SPEC, lambda: None))
    nodes = server.scene._handle_from_node_name
    floor.draw(shown(replace(TABLE, picture=np.zeros((2, 2, 3), np.uint8))))  # pyright: ignore
    assert "/world/floor" not in nodes
    floor.draw(shown(TABLE))  # pyright: ignore
    low = nodes["/world/floor"]
    assert low.position == pytest.approx([0.5, 0, 0.5 - 1.5 * SLAB_M])


@dataclass
class Seen:
    """A browser's camera, as viser has it."""

    position: np.ndarray = field(default_factory=lambda: np.zeros(3))
    look_at: np.ndarray = field(default_factory=lambda: np.ones(3))
    up_direction: np.ndarray = field(default_factory=lambda: np.array([0.0, 0, 1]))
    wxyz: np.ndarray = field(default_factory=lambda: np.array([1.0, 0, 0, 0]))
    fov: float = 0.8


def test_all_look_through_the_chosen_camera_and_get_their_view_back(
    dashboard: Dashboard, monkeypatch
):
    server, following = dashboard._server.viser, Following(False)
    seen = Seen()
    monkeypatch.setattr(server, "get_clients", lambda: {3: SimpleNamespace(camera=seen)})
    look = LookThrough(WidgetContext(server, SPEC, lambda: None), following)
    pose = CameraPose(np.array([1.0, 2, 3]), np.array([0.0, 1, 0, 0]), 0.5)
    with_camera = shown(TABLE, cameras={"front": pose})
    look.draw(shown(TABLE))  # pyright: ignore
    assert not look.choice.visible
    look.draw(with_camera)  # pyright: ignore
    assert look.choice.options == (FREE, "front")
    assert (seen.position == 0).all()
    look.choice.value = "front"
    look.draw(with_camera)  # pyright: ignore
    assert (seen.position == pose.position_m).all()
    assert (seen.wxyz == pose.wxyz).all()
    assert seen.fov == 0.5
    # The scene moves below a view that follows the tool, and a camera's place is another then.
    following.on = True
    look.draw(with_camera)  # pyright: ignore
    assert (seen.position == 0).all()
    assert seen.fov == 0.8
