"""Arms that are sold, of those whose packages are installed: UR5e's always is, for development."""

import mujoco
import numpy as np
import pytest
from dm_control import mjcf

from sheath_manip.exceptions import SetupError
from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.task import GraspTask
from sheath_manip.tasks.robots.arm_file import house_arms, path_of, read_arm
from sheath_manip.tasks.robots.described import arm_with_gripper
from sheath_manip.tasks.robots.models import located
from sheath_manip.types import Outcome, Purpose


def installed(name: str) -> bool:
    arm, path = read_arm(path_of(name)), path_of(name)
    try:
        located(arm.arm, path.parent, arm.package)
    except SetupError:
        return False
    return True


HERE = [name for name in house_arms() if installed(name)]


def test_the_arm_of_the_development_packages_is_there() -> None:
    assert "ur5e" in HERE


@pytest.mark.soak
@pytest.mark.parametrize("name", [name for name in HERE if name != "so101"])
def test_the_expert_grasps_without_touching_anything_else(name: str) -> None:
    environment = GRASP_CLUTTER.make(f"easy@{name}")
    assert isinstance(environment, ComposerEnvironment)
    task = environment.task
    assert isinstance(task, GraspTask)
    expert = GraspExpert(environment)
    observation = environment.reset(scene_seed(Purpose.EVALUATION, "arms", 0))
    assert [image.std() > 20 for image in observation.images.values()] == [True, True]
    expert.reset()
    # What the page gets of its meshes.
    vertices = sum(len(each.vertices) for each in environment.scene() if each.vertices is not None)
    assert 1000 < vertices < 50_000
    model, data = environment.physics.model.ptr, environment.physics.data.ptr
    deepest_m, most_closed_m = 0.0, 0.0
    for _ in range(200):
        transition = environment.step(expert.act(observation))
        observation = transition.observation
        most_closed_m = max(most_closed_m, task.drive.closed_m())
        deepest_m = min(deepest_m, float(data.contact.dist.min(initial=0.0)))
        if transition.terminated:
            break
    assert environment.outcome() is Outcome.SUCCESS
    assert environment.metrics()["tilt_deg"] < 5
    assert deepest_m > -0.003
    # The fingers stop at the can.
    width_m = 2 * task.scene.target.half_x_m
    assert task.scenario.robot.opening_m - most_closed_m == pytest.approx(width_m, abs=0.006)
    assert not any(int(each.number) for each in data.warning)
    assert model.nu == len(task.scenario.robot.servos) + 1
    environment.close()


@pytest.mark.parametrize("name", HERE)
def test_an_open_gripper_is_as_open_as_its_file_says(name: str) -> None:
    robot = arm_with_gripper(name)
    physics = mjcf.Physics.from_mjcf_model(robot.build())
    told = read_arm(path_of(name)).gripper
    pads = [f"gripper/{pad}" if told.model else pad for pad in told.pads]
    drive = [physics.model.actuator(robot.closing_servo).id]
    act = physics.model.ptr.actuator_actadr[drive]
    gaps_m = []
    for closed_m in (0.0, robot.opening_m / 2):
        for _ in range(1000):
            physics.data.act[act] = robot.coupling.coordinate(closed_m)
            mujoco.mj_step(physics.model.ptr, physics.data.ptr)
        first, *others = [physics.model.geom(pad).id for pad in pads]
        model, data = physics.model.ptr, physics.data.ptr
        gaps_m.append(max(mujoco.mj_geomDistance(model, data, first, o, 1, None) for o in others))
    np.testing.assert_allclose(gaps_m, [robot.opening_m, robot.opening_m / 2], atol=0.003)
