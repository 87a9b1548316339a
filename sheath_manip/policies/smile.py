"""SMILe's policy: at each step one of the policies of all rounds, the earlier the likelier.

Ross & Bagnell 2010, 'Efficient reductions for imitation learning' (AISTATS), algorithm 3.1:

    pi_n = (1 - α)^n expert + Σ_{j=1..n} α (1 - α)^(j-1) policy_j

where policy_j is trained on round j's states alone. The expert's part is the gate's (`Mixture` with
beta = (1 - α)^n); what is left, renormalised, is this policy, and all there is once nobody helps.
"""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.choices import choices_of, nearest_choices
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.protocols import Arrays, TrainablePolicy
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.samples import Samples


def expert_weight(alpha: float, members: int) -> float:
    """(1 - α)^n, which the mixture of n policies leaves to the expert."""
    return (1 - alpha) ** members


def member_weights(alpha: float, members: int) -> NDArray[np.float64]:
    """(n,) α (1 - α)^(j-1) for j = 1..n, renormalised to sum to 1 without the expert."""
    weights = alpha * (1 - alpha) ** np.arange(members, dtype=np.float64)
    return weights / (1 - expert_weight(alpha, members))


def as_first_member(arrays: Arrays) -> Arrays:
    """The learned state of the mixture of one policy with that learned state."""
    return flatten({"0": arrays})


class SmileMixture:
    """A draw, at each step, among policies each fitted to the states of one round."""

    def __init__(
        self,
        spec: TaskSpec,
        member: str = "linear-svm",
        alpha: float = 0.1,
        member_settings: Mapping[str, Any] | None = None,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters.

        Args:
            spec: of the task.
            member: name of the policies that are mixed.
            alpha: in (0, 1), the newest policy's share of what was the expert's.
            member_settings: their hyperparameters.
            seed: of the first weights of each, and of the draws before the first `reset`.
        """
        if not 0 < alpha < 1:
            raise ParameterError(f"alpha is {alpha}; wanted a share between 0 and 1, like 0.1")
        self.spec = spec
        self.member = member
        self.alpha = alpha
        self.member_settings = dict(member_settings or {})
        self.seed = seed
        self.members_: list[TrainablePolicy] = []
        self._rng = np.random.default_rng(seed)
        self._fresh()

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: draw from `rng` from now on."""
        self._rng = rng

    def fit(self, samples: Samples) -> Self:
        """Add a policy fitted to `samples`, those of the last round; it begins at the one before.

        That saves time, and keeps what was chosen once, such as the C of a support vector machine.
        """
        newest = self._fresh()
        if self.members_:
            newest.load(self.members_[-1].arrays())
        self.members_.append(newest.fit(samples))
        return self

    def predict(self, observations: Observations) -> Proposal:
        """Take the likeliest actions: those with the most weight behind them, nothing drawn.

        Latents: what each member says as (n, m, a) `members`, and in tasks with choices the (n, k)
        chance of each to be drawn as `choice scores`.
        """
        said = self._said(observations)
        same = (said[:, None] == said[None]).all(axis=3)
        support = np.einsum("j,ijn->in", self.weights(), same)
        likeliest = said[support.argmax(axis=0), np.arange(said.shape[1])]
        return Proposal(likeliest, self._latents(said))

    def propose(self, observations: Observations) -> Proposal:
        """Propose what the policy says that is drawn for this step.

        Latents: those of `predict`, so that a signal judges by what it was fitted to.
        """
        weights = self.weights()
        # By the cumulated weights, which `choice` would check anew at each step.
        drawn = int(np.searchsorted(np.cumsum(weights), self._rng.random(), side="right"))
        said = self._said(observations)
        return Proposal(said[min(drawn, len(weights) - 1)], self._latents(said))

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) the expected losses of the draw; of actions without latents, their own."""
        if "members" not in proposal.latents:
            return self.members_[0].surrogate_losses(proposal, labels)
        losses = [
            member.surrogate_losses(Proposal(proposal.latents["members"][:, number]), labels)
            for number, member in enumerate(self.members_)
        ]
        return (self.weights() @ np.stack(losses)).astype(np.float32)

    def weights(self) -> NDArray[np.float64]:
        """(n,) the chances of the n policies, the first round's first."""
        if not self.members_:
            raise ParameterError("the policy is not fitted yet; call fit or load first")
        return member_weights(self.alpha, len(self.members_))

    def arrays(self) -> Arrays:
        """Return the arrays of each policy, by its number."""
        self.weights()
        return flatten({str(j): member.arrays() for j, member in enumerate(self.members_)})

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        numbers = sorted({int(name.partition("/")[0]) for name in arrays})
        self.members_ = [self._fresh().load(subtree(arrays, str(number))) for number in numbers]
        return self

    def _said(self, observations: Observations) -> NDArray[np.float32]:
        """(m, n, a) what each member says."""
        self.weights()
        return np.stack([member.predict(observations).now for member in self.members_])

    def _latents(self, said: NDArray[np.float32]) -> dict[str, NDArray]:
        latents: dict[str, NDArray] = {"members": said.swapaxes(0, 1)}
        if self.spec.action.choices is not None:
            latents["choice scores"] = self._chances(said)
        return latents

    def _chances(self, said: NDArray[np.float32]) -> NDArray[np.float64]:
        choices, (members, states, width) = choices_of(self.spec), said.shape
        chosen = nearest_choices(choices, said.reshape(-1, width)).reshape(members, states)
        chances, rows = np.zeros((states, len(choices))), np.arange(states)
        for weight, choice in zip(self.weights(), chosen, strict=True):
            chances[rows, choice] += weight
        return chances

    def _fresh(self) -> TrainablePolicy:
        # Only now: the table of policies lists this one.
        from sheath_manip.policies import make_policy

        return make_policy(self.member, self.spec, self.seed, **self.member_settings)
