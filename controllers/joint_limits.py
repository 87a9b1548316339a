"""What the joints of an arm may be commanded."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Limits: range, speed, acceleration, jerk by joint, all (j,) and symmetric but the range."""

    lower_rad: NDArray[np.float64]
    upper_rad: NDArray[np.float64]
    speeds_rad_s: NDArray[np.float64]
    accelerations_rad_s2: NDArray[np.float64]
    jerks_rad_s3: NDArray[np.float64]

    def __post_init__(self) -> None:
        size = self.lower_rad.shape
        rates = (self.speeds_rad_s, self.accelerations_rad_s2, self.jerks_rad_s3)
        positive = all(rate.shape == size and (rate > 0).all() for rate in rates)
        if not positive or self.upper_rad.shape != size or (self.lower_rad > self.upper_rad).any():
            raise ParameterError(
                f"joint limits {self}; wanted one lower end, upper end not below it, and positive "
                "speed, acceleration and jerk a joint"
            )

    @classmethod
    def of(
        cls,
        model: mujoco.MjModel,
        speeds_rad_s: Sequence[float],
        rise_s: float = 0.15,
        onset_s: float = 0.05,
    ) -> "JointLimits":
        """Limits of the arm that is alone in `model`, its ranges from there.

        Top speed is reached in `rise_s` at full acceleration, and full acceleration in `onset_s`.
        """
        speeds = np.array(speeds_rad_s, float)
        limited = model.jnt_limited.astype(bool)
        lower, upper = model.jnt_range.T
        accelerations = speeds / rise_s
        return cls(
            np.where(limited, lower, -np.inf),
            np.where(limited, upper, np.inf),
            speeds,
            accelerations,
            accelerations / onset_s,
        )
