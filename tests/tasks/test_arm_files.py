"""An arm from a file: the house's own parts described by one, and what is said of a bad one."""

import pickle
import re
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.exceptions import SheathError, UnknownNameError
from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.entry import GAUZE_CUTTING
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.scene import EASY
from sheath_manip.tasks.grasp_clutter.task import GraspTask, Scenario
from sheath_manip.tasks.robots.arm_file import Source, house_arms, path_of, read_arm
from sheath_manip.tasks.robots.described import arm_with_blade, arm_with_gripper
from sheath_manip.tasks.robots.gripper import Measured
from sheath_manip.tasks.robots.kinematics import twist_control
from sheath_manip.tasks.robots.models import located
from sheath_manip.tasks.robots.motions import lacking, said
from sheath_manip.tasks.robots.own_arm import ARM_WITH_JAW
from sheath_manip.tasks.robots.robot import ASSETS, RobotDescription
from sheath_manip.tasks.robots.thinning import clustered
from sheath_manip.types import Outcome, Purpose

OWN = """
title = "the house's arm"
licence = "MIT"
arm = "arm.xml"
joints = [
  { name = "base_yaw", home_rad = 0.0, speed_rad_s = 1.5, kp = 3000.0, force_n_m = 200.0 },
  { name = "shoulder", home_rad = -1.509, speed_rad_s = 1.5, kp = 3000.0, force_n_m = 200.0 },
  { name = "elbow", home_rad = 1.857, speed_rad_s = 2.0, kp = 3000.0, force_n_m = 200.0 },
  { name = "wrist_pitch", home_rad = 1.048, speed_rad_s = 3.0, kp = 500.0, force_n_m = 40.0 },
  { name = "wrist_yaw", home_rad = 0.0, speed_rad_s = 3.0, kp = 500.0, force_n_m = 40.0 },
  { name = "wrist_roll", home_rad = 0.0, speed_rad_s = 3.0, kp = 500.0, force_n_m = 40.0 },
]
[mount]
at = "tool_mount"
approach = [1.0, 0.0, 0.0]
across = [0.0, 1.0, 0.0]
[gripper]
model = "jaw.xml"
body = "palm"
pinch_m = [0.12, 0.0, 0.0]
approach = [1.0, 0.0, 0.0]
across = [0.0, 1.0, 0.0]
joints = { left_finger = 1.0, right_finger = 1.0 }
closed_m = [[0.0, 0.0], [0.092, 0.092]]
kp = 2000.0
lag_s = 0.01
force = 40.0
tip_m = 0.035
depth_m = 0.05
pads = ["left_pad", "right_pad"]
footprints = [
  { half_along_m = 0.057, half_across_m = 0.011, above_tool_m = -0.035 },
  { half_along_m = 0.062, half_across_m = 0.018, above_tool_m = 0.085 },
]
"""


def written(folder: Path, text: str = OWN, *without: str) -> Path:
    """The arm's file with its models beside it, their lines about `without` left out."""
    for name in ("arm.xml", "jaw.xml"):
        model = (ASSETS / name).read_text()
        for each in without:
            model = re.sub(rf'<(joint|intvelocity)[^>]*name="{each}"[^>]*/>', "", model)
            text = re.sub(rf'  {{ name = "{each}".*\n', "", text)
        (folder / name).write_text(model)
    path = folder / "arm.toml"
    path.write_text(text)
    return path


def grasped(robot: RobotDescription, number: int = 0) -> Outcome:
    """How the expert fares in an easy scene that no camera sees."""
    environment = ComposerEnvironment(GraspTask(Scenario(difficulty=EASY, robot=robot, cameras=())))
    expert = GraspExpert(environment)
    observation = environment.reset(scene_seed(Purpose.EVALUATION, "tests", number))
    expert.reset()
    for _ in range(200):
        transition = environment.step(expert.act(observation))
        observation = transition.observation
        if transition.terminated:
            break
    outcome = environment.outcome()
    environment.close()
    return outcome


def test_the_house_arm_from_a_file_is_the_house_arm(tmp_path: Path) -> None:
    robot = arm_with_gripper(str(written(tmp_path)))
    home = np.array(ARM_WITH_JAW.home_rad)
    poses = [
        twist_control(each, 0.05).transform_tool_to_world(home) for each in (robot, ARM_WITH_JAW)
    ]
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-9)
    assert robot.joint_speeds_rad_s == ARM_WITH_JAW.joint_speeds_rad_s
    fingers = {"jaw/palm", "jaw/left_pad", "upper_arm", "flange"}
    assert {each.replace("gripper/", "jaw/") for each in robot.body_geoms} >= fingers
    assert grasped(robot) is Outcome.SUCCESS


def test_the_knife_waits_straight_down_over_the_sheet(tmp_path: Path) -> None:
    robot = arm_with_blade(str(written(tmp_path)))
    pose = twist_control(robot, 0.05).transform_tool_to_world(np.array(robot.home_rad))
    np.testing.assert_allclose(pose[:3, 3], [0.42, 0.0, 0.20], atol=1e-3)
    np.testing.assert_allclose(pose[:3, 0], [0.0, 0.0, -1.0], atol=1e-3)


def test_an_arm_of_five_joints_says_what_it_lacks(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert lacking(ARM_WITH_JAW) == ()
    assert said(ARM_WITH_JAW) is None
    robot = arm_with_gripper(str(written(tmp_path, OWN, "wrist_yaw")))
    # Pitch and yaw of the base turn the tool about y and z, and so does nothing about x.
    assert lacking(robot) == ("turn about x",)
    line = said(robot)
    assert line is not None
    assert "5 joints" in line
    assert "cannot turn about x" in line
    path = tmp_path / "arm.toml"
    for _ in range(2):
        GAUZE_CUTTING.make(f"calm@{path}").close()
    assert [each for each in caplog.messages if line in each] == [f"{path}: {line}"]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('licence = "MIT"', "licence = ", "no TOML"),
        ('licence = "MIT"', "", "missing required field `licence`"),
        ("kp = 2000.0", 'kp = "stiff"', "Expected `float`, got `str`"),
        ("kp = 2000.0", "kp = 2000.0\ncolour = 1", "unknown field `colour`"),
        ('arm = "arm.xml"', 'arm = "leg.xml"', "no model leg.xml in"),
        ('name = "elbow"', 'name = "knee"', "has no joint 'knee'; it has base_yaw"),
        ('at = "tool_mount"', 'at = "wall"', "has no body 'wall'"),
        ('"left_pad", ', '"pillow", ', "has no geom 'pillow'"),
        ("[[0.0, 0.0], [0.092, 0.092]]", "[[0.0, 0.0]]", "wanted two points or more"),
        ("{ left_finger = 1.0, right_finger = 1.0 }", "{}", "gripper of 0"),
    ],
)
def test_each_fault_of_a_file_is_said_in_one_line(old, new, says, tmp_path: Path) -> None:
    assert old in OWN
    with pytest.raises(SheathError, match=re.escape(says)) as raised:
        arm_with_gripper(str(written(tmp_path, OWN.replace(old, new))))
    assert "\n" not in str(raised.value)


def test_a_file_that_is_not_there_is_said_in_one_line() -> None:
    with pytest.raises(SheathError, match=r"no arm in nowhere.toml"):
        GRASP_CLUTTER.make("easy@nowhere.toml")


def test_models_are_found_beside_the_file_in_the_menagerie_and_in_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = Source(
        package="an-arm", folder="an_arm/models", install="pip install an-arm", menagerie=True
    )
    monkeypatch.delenv("MENAGERIE_ROOT", raising=False)
    monkeypatch.syspath_prepend(tmp_path / "site")
    places = [tmp_path / name for name in ("site/an_arm/models", "menagerie", "beside")]
    for place in places:
        place.mkdir(parents=True)
    (places[0].parent / "__init__.py").write_text("raise ImportError('nothing is imported')")
    with pytest.raises(SheathError, match=r"install an-arm with `pip install an-arm`, or set MEN"):
        located("arm.xml", places[2], source)
    for place in places:
        (place / "arm.xml").touch()
        if place.name != "models":
            monkeypatch.setenv("MENAGERIE_ROOT", str(places[1]))
        assert located("arm.xml", places[2], source) == place / "arm.xml"


def test_a_variant_names_its_arm() -> None:
    for task in (GRASP_CLUTTER, GAUZE_CUTTING):
        variants = task.variants
        assert {"default", "final", "jaco", *house_arms()} <= set(variants)
        assert "default@jaco" in variants
        assert "final@my.toml" in variants
        assert "my.toml" not in set(variants)
        for unknown in ("ur", "hardest@ur5e", "default@", "@"):
            with pytest.raises(UnknownNameError):
                task.make(unknown)
        assert set(pickle.loads(pickle.dumps(variants))) == set(variants)


@pytest.mark.parametrize("name", house_arms())
def test_the_files_of_the_house_can_be_read(name: str) -> None:
    arm = read_arm(path_of(name))
    assert arm.package is not None
    assert arm.package.install.startswith("pip install ")


def test_a_measured_coupling_goes_both_ways_and_on() -> None:
    coupling = Measured(((0.8, 0.0), (0.5, 0.03), (0.0, 0.08)))
    for closed_m in (-0.01, 0.0, 0.02, 0.05, 0.08, 0.09):
        assert coupling.closed_m(coupling.coordinate(closed_m)) == pytest.approx(closed_m)
    assert coupling.closed_m(0.65) == pytest.approx(0.015)
    assert coupling.coordinate(0.09) == pytest.approx(-0.1)


def test_a_thinned_mesh_has_one_point_a_cell() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(20) / 1000] * 2), -1).reshape(-1, 2)
    points = np.column_stack([grid, np.zeros(len(grid))])
    corner = np.arange(400).reshape(20, 20)[:-1, :-1].ravel()
    faces = np.concatenate([corner[:, None] + [0, 1, 20], corner[:, None] + [1, 21, 20]])
    thin, joined = clustered(points, faces, 0.005)
    assert len(thin) == 16
    assert len(joined) == 18
    edges = thin[joined[:, 1:]] - thin[joined[:, :1]]
    areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(0.015**2)
