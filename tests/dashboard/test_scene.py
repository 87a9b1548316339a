import numpy as np

from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.camera import FIELD_OF_VIEW_RAD
from sheath_manip.dashboard.scene import SceneView
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.protocols import Viewable
from tests.dashboard.conftest import SPEC


def desk_of(dashboard: Dashboard) -> WidgetContext:
    return WidgetContext(dashboard._server.viser, SPEC, lambda: None)


def test_camera_sees_all_that_stands_on_the_ground(
    dashboard: Dashboard, environment: Viewable
) -> None:
    server = dashboard._server.viser
    pose = environment.pose()
    SceneView(desk_of(dashboard)).build(environment.scene(), pose)
    camera = server.initial_camera
    forward = camera.look_at - camera.position
    forward /= np.linalg.norm(forward)
    seen = pose.bodies[1:, :3] - camera.position
    ahead = seen @ forward
    aside = np.linalg.norm(seen - np.outer(ahead, forward), axis=1)
    assert (ahead > 0).all()
    assert np.arctan2(aside, ahead).max() < FIELD_OF_VIEW_RAD / 2
    # The ground is three times as wide; the camera does not step back for it.
    assert np.linalg.norm(camera.look_at - camera.position) < 80


def test_camera_is_aimed_once(dashboard: Dashboard, environment: Viewable) -> None:
    view = SceneView(desk_of(dashboard))
    view.build(environment.scene(), environment.pose())
    aimed = dashboard._server.viser.initial_camera.position
    shown = view._scene
    view.build(list(environment.scene()), environment.pose())
    assert view._scene is shown
    view.build(environment.scene()[1:], environment.pose())
    assert view._scene is not shown
    assert dashboard._server.viser.initial_camera.position is aimed
