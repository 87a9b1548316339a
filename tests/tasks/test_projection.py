"""Where a camera shows what lies in a plane, against what dm_control's own camera says."""

from typing import Any

import numpy as np
import pytest
from dm_control import mjcf
from dm_control.mujoco import engine

from sheath_manip.tasks.projection import px_of_horizontal_plane

HEIGHT_M = 0.2


@pytest.mark.parametrize("xyaxes", [(0, 1, 0, -0.872, 0, 0.49), (2, 0, 0, 0.5, 3, 1)])
def test_is_that_of_the_rendered_picture(xyaxes):
    world: Any = mjcf.RootElement()
    camera = world.worldbody.add(
        "camera", name="above", pos=(0.6, 0.1, 1.5), xyaxes=xyaxes, fovy=30
    )
    world.worldbody.add("geom", type="sphere", size=[0.1])
    physics = mjcf.Physics.from_mjcf_model(world)
    matrix = engine.Camera(physics, height=64, width=64, camera_id="above").matrix
    for x, y in ((0.4, 0.0), (0.5, 0.12), (0.31, -0.05)):
        expected = matrix @ [x, y, HEIGHT_M, 1]
        seen = px_of_horizontal_plane(camera, 64, HEIGHT_M) @ [x, y, 1]
        np.testing.assert_allclose(seen[:2] / seen[2], expected[:2] / expected[2], atol=1e-6)
