"""What a variant of the task may change, and what learners are told of the task then."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sheath_manip.tasks.gauze_cutting.geometry import CENTRE_M
from sheath_manip.tasks.gauze_cutting.scene import DEFAULT, Difficulty
from sheath_manip.tasks.gauze_cutting.steering import PLANAR_VELOCITY, Steering
from sheath_manip.tasks.projection import px_of_horizontal_plane
from sheath_manip.tasks.robots.own_arm import ARM_WITH_BLADE
from sheath_manip.tasks.robots.robot import RobotDescription
from sheath_manip.types import FirstView, TaskSpec, ToolFrame

CONTROL_TIMESTEP_S = 0.05
IMAGE_PX = 96
CAMERA = "overhead"
_PLANE = ("tool_x_m", "tool_y_m")
_HEADING = ("heading_cos", "heading_sin")
_SAG_M = 0.002
"""of the plane that the blade's way is seen in, below the clips"""


@dataclass(frozen=True)
class Scenario:
    """A scenario: what a variant of the task may change."""

    difficulty: Difficulty = DEFAULT
    steering: Steering = PLANAR_VELOCITY
    robot: RobotDescription = ARM_WITH_BLADE
    cameras: tuple[str, ...] = (CAMERA,)
    time_limit_s: float = 15.0


def spec_of(scenario: Scenario, cameras: Mapping[str, tuple[int, int]], overhead: Any) -> TaskSpec:
    """What learners are told of the task in `scenario`.

    `cameras` are those of the scenario with (height, width) of their images, px; `overhead` is the
    MJCF element of the camera that stands over the sheet.
    """
    return TaskSpec(
        name="gauze-cutting",
        control_rate_hz=1 / CONTROL_TIMESTEP_S,
        action=scenario.steering.action,
        cameras=cameras,
        feature_names=(*_PLANE, "tool_z_m", *_HEADING),
        max_steps=round(scenario.time_limit_s / CONTROL_TIMESTEP_S),
        metric="iou",
        plane=_PLANE,
        tool_frame=_tool_frame(scenario, overhead) if CAMERA in scenario.cameras else None,
        first_view=FirstView(0.13, azimuth_deg=145.0, elevation_deg=40.0),
    )


def _tool_frame(scenario: Scenario, overhead: Any) -> ToolFrame:
    sheet_m = CENTRE_M[2] - _SAG_M
    return ToolFrame(
        camera=CAMERA,
        px_of_plane=px_of_horizontal_plane(overhead, IMAGE_PX, sheet_m),
        position=_PLANE,
        heading=_HEADING,
        vector=scenario.steering.vector,
    )
