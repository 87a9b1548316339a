"""States that the driving expert does not come to, and its regret of an action.

A displacement sets one of the track's coordinates (s, lateral, heading from the road) and keeps the
others, so that its name says how far from the road's middle or direction the car stands.
"""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.probes import Displacement, Probes
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.study.gate_claims import CLAIMS
from sheath_manip.tasks.driving.task import TRAFFIC_SPEED_M_S, DrivingTask
from sheath_manip.types import Action, Observation

FRONT_GAP_M = 2.1
"""between the centres of two cars of 2.0 m, one behind the other: all but a crash"""
COSTLY_REGRET = 5.0
"""the planner's comfort within its horizon differs by less between sound ways to go on; its crash
costs hundreds"""


def beside(lateral_m: float, environment: ComposerEnvironment, rng: np.random.Generator):
    """Put the car `lateral_m` from the centre line, to either side."""
    task = _task(environment)
    x, y, heading = task.pose(environment.physics)
    along = task.track.coordinates(x, y)[0]
    pose = task.track.pose(along, rng.choice([-1.0, 1.0]) * lateral_m)
    pose[2] = heading
    return _placed(environment, pose)


def turned(angle_deg: float, environment: ComposerEnvironment, rng: np.random.Generator):
    """Turn the car on the spot until it points `angle_deg` off the road, to either side."""
    task = _task(environment)
    pose = task.pose(environment.physics)
    road = task.track.coordinates(pose[0], pose[1])[2]
    pose[2] = road + rng.choice([-1.0, 1.0]) * np.deg2rad(angle_deg)
    return _placed(environment, pose)


def blocked(environment: ComposerEnvironment, rng: np.random.Generator) -> Observation:
    """Put one of the other cars right in front."""
    del rng
    task, physics = _task(environment), environment.physics
    x, y, _ = task.pose(physics)
    along, lateral, _ = task.track.coordinates(x, y)
    traffic = task.traffic_start
    traffic[0] = along + FRONT_GAP_M - TRAFFIC_SPEED_M_S * physics.time(), lateral
    task.set_traffic(physics, traffic)
    physics.forward()
    return environment.observe()


def regret(expert: DrivingExpert, action: Action) -> float:
    """How much dearer than the planner's best `action` (1,) and the best to follow it are."""
    return float(expert.regrets()[expert.choice_of(action)])


# The expert itself comes 2.7 m from the centre line, at its 90th percentile.
_BESIDE_M = {2.5: False, 3.5: True, 5.0: True, 7.0: True}
_TURNED_DEG = (45.0, 90.0)

PROBES = Probes(
    displacements=(
        *(
            Displacement(f"lateral {lateral_m:g} m", partial(beside, lateral_m), far)
            for lateral_m, far in _BESIDE_M.items()
        ),
        *(
            Displacement(f"heading {angle_deg:g}°", partial(turned, angle_deg))
            for angle_deg in _TURNED_DEG
        ),
        Displacement("car in front", blocked),
    ),
    regret=regret,
    costly_regret=COSTLY_REGRET,
    claims=CLAIMS,
)


def _placed(environment: ComposerEnvironment, pose: NDArray) -> Observation:
    _task(environment).place(environment.physics, pose)
    environment.physics.forward()
    return environment.observe()


def _task(environment: ComposerEnvironment) -> DrivingTask:
    if not isinstance(environment.task, DrivingTask):
        raise TypeError(f"driving's probes want a DrivingTask, got {environment.task!r}")
    return environment.task
