"""HG-DAgger's person, simulated: he watches, notices late, and drives until all is well again.

No machine tells him when. He knows what he would do himself, sees that the policy does otherwise
for a while, and takes over once his reaction is over; what fails faster than that fails.
"""

from collections import deque

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Expert
from sheath_manip.rollout.simulated_operator import SimulatedOperator
from sheath_manip.types import Action, Observation, TaskSpec

ROUNDING = 1e-6
WHILE_S = 0.5
"""over which a policy is judged: one odd action is no reason to take over"""


class AttentivePerson:
    """Drives where the policy would do otherwise than the expert in half of the last while."""

    def __init__(
        self, expert: Expert, spec: TaskSpec, operator: SimulatedOperator, while_s: float = WHILE_S
    ) -> None:
        """Store what he knows and who he is.

        Args:
            expert: asked at every step, so it must not mind to be asked again by the rollout.
            spec: of the task: by its tolerance two actions count as the same.
            operator: says how soon he reacts, and for how long he stays.
            while_s: over which he judges the policy; 0 is the present step alone.
        """
        if not 0 <= while_s < np.inf:
            raise ParameterError(f"while_s is {while_s}; wanted at least 0, like {WHILE_S}")
        self.expert = expert
        self.operator = operator
        action = spec.action
        self._tolerance = ROUNDING + action.tolerance * (action.maximum - action.minimum)
        steps = max(1, round(while_s * spec.control_rate_hz))
        self._otherwise: deque[bool] = deque(maxlen=steps)

    def reset(self, rng: np.random.Generator) -> None:
        """Let the policy have the wheel."""
        self.operator.leave()
        self.operator.begin(rng)
        self._otherwise.clear()

    def wants(self, observation: Observation, proposed: Action) -> bool:
        """Return whether he drives this step."""
        apart = np.abs(self.expert.act(observation) - proposed)
        self._otherwise.append(bool((apart > self._tolerance).any()))
        share = sum(self._otherwise) / (self._otherwise.maxlen or 1)
        return self.operator.drives(share >= 0.5, observation.time_s)
