"""A gate around anybody's control loop."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from sheath_manip.exceptions import ActionError
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.making import make_gate
from sheath_manip.protocols import Gate, Replans
from sheath_manip.rollout.checking import kept_observation, kept_proposal
from sheath_manip.rollout.deciding import GuardedGate
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, TaskSpec


class LoopGate:
    """Says at each step of a loop of your own whether the policy may act; made by `load_gate`.

    It fails safe: without a proposal, with a number that is none in what is seen or proposed, and
    whatever breaks down inside, the expert is to act.
    """

    fault: str = ""
    """why the last decision was made without a score; empty where it has one, or none was asked"""

    def __init__(self, fitted: FittedGate, spec: TaskSpec) -> None:
        """Store what was fitted, and what it is asked of: observations and actions of `spec`."""
        self.fitted = fitted
        self.spec = spec
        # Elsewhere another loop's clock is no business of ours.
        by_time = fitted.config.requests.limits
        self._checked = _Checked(make_gate(fitted), spec, by_time)
        self._gate = GuardedGate(self._checked)

    def reset(self, seed: int | np.random.Generator = 0) -> None:
        """Begin an episode, for the gate and for its policy; `seed` is what both draw from."""
        rng = np.random.default_rng(seed)
        self.fault = ""
        self._gate.reset(rng)
        self.fitted.policy.reset(rng)

    def decide(
        self, observation: Observation, proposal: Proposal | ArrayLike | None
    ) -> GateDecision:
        """Decide for one step: `actor` of the answer is `policy` or `expert`, `reason` says why.

        Where it is not the policy, one that plans ahead hears that its plan is void.

        Args:
            observation: what is seen. Where requests are limited, by `--gate.requests`, its
                `time_s` counts, in seconds of the episode, and has to go on: else no turn ends.
            proposal: of the policy for this very observation. An action (a,) does where the
                gate's embeddings read no latent; None where there is none to be executed.
        """
        self._checked.fault = ""
        kept, fault = self._kept(proposal)
        decision = self._gate.decide(observation, kept)
        self.fault = self._checked.fault or fault
        policy = self.fitted.policy
        if decision.actor is not Actor.POLICY and isinstance(policy, Replans):
            policy.replan()
        return decision

    def _kept(self, proposal: Proposal | ArrayLike | None) -> tuple[Proposal | None, str]:
        """What may be executed, or why there is nothing."""
        if proposal is None:
            return None, ""
        action = self.spec.action
        try:
            if not isinstance(proposal, Proposal):
                proposal = Proposal(action.validated(proposal)[None])
            return kept_proposal(proposal, action), ""
        except ActionError as error:
            return None, str(error)


class _Checked:
    """A gate that is shown nothing but what it was fitted to; the guard hears of the rest."""

    def __init__(self, gate: Gate, spec: TaskSpec, by_time: bool) -> None:
        self.gate = gate
        self.spec = spec
        self.by_time = by_time
        self.fault = ""

    def reset(self, rng: np.random.Generator) -> None:
        self.gate.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        try:
            # Another loop's numbers are as often doubles.
            features = np.asarray(observation.features, np.float32)
            time_s = observation.time_s if self.by_time else 0.0
            shown = replace(observation, features=features, time_s=time_s)
            return self.gate.decide(kept_observation(shown, self.spec), proposal)
        except Exception as error:
            self.fault = f"{type(error).__name__}: {error}"
            raise
