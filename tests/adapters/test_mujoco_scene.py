import mujoco
import numpy as np
import pytest

from sheath_manip.adapters.mujoco_scene import scene_geoms

MODEL = """
<mujoco>
  <asset>
    <material name="red" rgba="1 0 0 1"/>
    <texture name="check" type="2d" builtin="flat" width="2" height="2" rgb1="0 0 1"/>
    <material name="checked" texture="check"/>
  </asset>
  <worldbody>
    <geom name="endless" type="plane" size="0 0 .05" material="checked"/>
    <geom name="strip" type="plane" size="0 2 .05"/>
    <geom name="plain" size=".1" material="red"/>
    <geom name="own" size=".1" material="red" rgba="0 1 0 1"/>
    <geom name="unseen" size=".1" material="red" rgba="0 1 0 0"/>
    <geom name="hidden" size=".1" group="3"/>
    <body pos="4 0 0"><geom name="far" size=".1"/></body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def shown() -> dict:
    model = mujoco.MjModel.from_xml_string(MODEL)
    seen = [model.geom(index).name for index in range(model.ngeom)]
    names = [name for name in seen if name not in ("unseen", "hidden")]
    return dict(zip(names, scene_geoms(model), strict=True))


def test_a_geom_is_drawn_in_its_own_colour_before_its_materials(shown) -> None:
    assert shown["plain"].rgba == (1, 0, 0, 1)
    assert shown["own"].rgba == (0, 1, 0, 1)
    assert shown["far"].rgba == (0.5, 0.5, 0.5, 1)


def test_a_plane_without_an_end_reaches_beyond_all_that_stands_on_it(shown) -> None:
    along, across, _ = shown["endless"].size
    assert along == across > 4
    assert shown["strip"].size[0] > 4
    assert shown["strip"].size[1] == 2
    np.testing.assert_array_equal(shown["endless"].picture, np.full((2, 2, 3), (0, 0, 255)))
