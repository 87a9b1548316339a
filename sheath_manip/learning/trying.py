"""One look through a policy and its gate, to see that what was loaded belongs together."""

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.types import Observation, TaskSpec


def require_works(spec: TaskSpec, fitted: FittedGate) -> None:
    """Let the policy look at an empty scene of the task, and the gate's signal judge it.

    Arrays of sizes that do not belong together raise here what they would raise in the control
    loop. Nothing is asked of the values, which say little of an empty scene. Raises ParameterError
    for an action of another shape.
    """
    black = {name: np.zeros((*size, 3), np.uint8) for name, size in spec.cameras.items()}
    empty = Observation(black, np.zeros(len(spec.feature_names), np.float32), 0.0)
    with np.errstate(all="ignore"):
        proposal = fitted.policy.predict(empty.alone)
        wanted = (1, len(spec.action.names))
        if np.shape(proposal.now) != wanted:
            raise ParameterError(
                f"the policy proposes an action of shape {np.shape(proposal.now)}; wanted {wanted}"
            )
        if fitted.signal is not None:
            fitted.judge(empty, proposal, np.inf)
