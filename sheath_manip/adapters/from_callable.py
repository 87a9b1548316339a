"""A policy for the gate of any function that says what to do in what is observed."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.choices import zero_one_losses
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.types import ActionSpec, Observation, Observations, Proposal

NO_CLOCK = float("nan")
"""`Observation.time_s` of what a policy is shown, which is told no time"""


def from_callable(
    act: Callable[[Any], Any],
    *,
    batched: bool = False,
    history: int = 1,
    action: ActionSpec | None = None,
    reset: Callable[[np.random.Generator], object] | None = None,
) -> "CallablePolicy":
    """Return a policy that proposes what `act` answers, so that a gate can be fitted around it.

    Args:
        act: called with an `Observation`, whose `time_s` is NaN. Returns an action (a,), or a chunk
            (k, a) of the next k, which are proposed one by one before it is called again, unless
            somebody else acts in between. It may return a `Proposal` for one state, too, whose
            latents an embedding can read: within a chunk they are those of its first step.
        batched: `act` is called with `Observations` of n instead, and returns (n, a) or (n, k, a).
        history: h >= 1 observations that `act` is shown. Above 1 all arrays have an axis more, the
            oldest first: features (h, f), images (h, height, width, 3), after the axis n of
            batches; before the h-th step the first is there several times.
        action: the action space, by which `surrogate_losses` tell how far an action is from its
            label; each dimension from -1 to 1 where None.
        reset: called with a generator at the beginning of each episode; may keep it, to draw from.

    Raises ParameterError for a history of less than 1.
    """
    if history < 1:
        raise ParameterError(f"history is {history}; wanted at least 1, the present observation")
    return CallablePolicy(act if batched else _one_by_one(act), history, action, reset)


@final
class CallablePolicy:
    """A policy that somebody's function is behind; made by `from_callable`."""

    def __init__(
        self,
        act: Callable[[Observations], Any],
        history: int,
        action: ActionSpec | None,
        reset: Callable[[np.random.Generator], object] | None,
    ) -> None:
        self.act = act
        self.history = history
        self.action = action
        self._reset = reset
        self._past: deque[Observations] = deque(maxlen=history)
        self._plan: Proposal | None = None

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: forget observations and plan, and reset what is behind it."""
        self._past.clear()
        self._plan = None
        if self._reset is not None:
            self._reset(rng)

    def replan(self) -> None:
        """Forget the rest of the chunk."""
        self._plan = None

    def propose(self, observations: Observations) -> Proposal:
        """Propose the next action of the chunk that is left, else of a new one."""
        self._past.append(observations)
        proposal = self._plan
        if proposal is None:
            proposal = self._asked(_side_by_side(self._past, self.history))
        left = proposal.actions[:, 1:] if proposal.actions.ndim == 3 else proposal.actions[:0]
        self._plan = Proposal(left, proposal.latents) if left.size else None
        return proposal

    def predict(self, observations: Observations) -> Proposal:
        """Look at n states, each as at the beginning of an episode."""
        return self._asked(_side_by_side([observations], self.history))

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """Return (n,) in 0..1: 0 or 1 where actions are choices, else a share of their range."""
        if self.action is not None and self.action.choices is not None:
            return zero_one_losses(self.action.choices, proposal.now, labels)
        return largest_deviations(self.action or _unit(labels.shape[1]), proposal.now, labels)

    def _asked(self, shown: Observations) -> Proposal:
        answer = self.act(shown)
        proposal = answer if isinstance(answer, Proposal) else Proposal(np.asarray(answer))
        actions = np.asarray(proposal.actions)
        if actions.ndim not in (2, 3) or len(actions) != len(shown) or 0 in actions.shape[1:]:
            raise ParameterError(
                f"the policy answers {actions.shape} for {len(shown)} states; wanted "
                "(n, a) actions or (n, k, a) chunks of them: for one state (a,) or (k, a)"
            )
        if actions.dtype.kind in "fiu":
            # What is no number the loop refuses, and says so.
            actions = actions.astype(np.float32)
        return Proposal(actions, proposal.latents)


def _one_by_one(act: Callable[[Observation], Any]) -> Callable[[Observations], Proposal]:
    def of_each(observations: Observations) -> Proposal:
        told = observations.instructions or ("",) * len(observations)
        answers = [
            act(
                Observation(
                    {camera: images[row] for camera, images in observations.images.items()},
                    observations.features[row],
                    NO_CLOCK,
                    told[row],
                )
            )
            for row in range(len(observations))
        ]
        if not all(isinstance(answer, Proposal) for answer in answers):
            return Proposal(np.stack([np.asarray(answer) for answer in answers]))
        latents = {
            name: np.concatenate([np.asarray(answer.latents[name]) for answer in answers])
            for name in answers[0].latents
        }
        return Proposal(np.concatenate([answer.actions for answer in answers]), latents)

    return of_each


def _side_by_side(past: Sequence[Observations], history: int) -> Observations:
    """The last `history` observations on an axis of their own, the present one last."""
    present = past[-1]
    if history == 1:
        return present
    shown = [past[0]] * (history - len(past)) + list(past)
    images = {
        camera: np.stack([each.images[camera] for each in shown], axis=1)
        for camera in present.images
    }
    features = np.stack([each.features for each in shown], axis=1)
    return Observations(images, features, present.instructions)


def _unit(size: int) -> ActionSpec:
    one = np.ones(size, np.float32)
    return ActionSpec(tuple(f"action {place}" for place in range(size)), -one, one)
