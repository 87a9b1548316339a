"""A LeRobot policy as the loop asks it: a plan of several steps, and a look at many states."""

from collections import deque
from collections.abc import Callable
from typing import Any, final

import numpy as np
import torch
from numpy.typing import NDArray

from sheath_manip.adapters.lerobot_chunks import Batch, Chunks
from sheath_manip.adapters.lerobot_inputs import Inputs
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.types import ActionSpec, Observations, Proposal


@final
class LeRobotPolicy:
    """Drives with LeRobot's network between LeRobot's pipelines; made by `load_policy`.

    A chunk is planned by one forward pass, and proposed until it is used up or somebody else has
    acted. No latents go along: within a chunk no network looks at the state that is judged, so
    the embeddings of a gate are those of pixels and features.
    """

    def __init__(
        self,
        chunks: Chunks,
        inputs: Inputs,
        preprocess: Callable[[dict[str, Any]], Batch],
        postprocess: Callable[[torch.Tensor], torch.Tensor],
        action: ActionSpec,
        bounded: bool,
        task: str,
    ) -> None:
        """Store the parts.

        Args:
            chunks: makes chunks of what it sees.
            inputs: where in an observation that is.
            preprocess: LeRobot's pipeline before the network.
            postprocess: LeRobot's pipeline after it, of (n, a).
            action: by whose range surrogate losses are told.
            bounded: whether actions are kept within its bounds.
            task: what is to be done, in words.
        """
        self.chunks = chunks
        self.inputs = inputs
        self.action = action
        self._preprocess = preprocess
        self._postprocess = postprocess
        self._bounded = bounded
        self._task = task
        self._rng = np.random.default_rng(0)
        self._past: deque[Observations] = deque(maxlen=chunks.history)
        self._plan: NDArray[np.float32] | None = None

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: forget past and plan, and draw from `rng` from now on."""
        self._rng = rng
        self._past.clear()
        self.replan()

    def replan(self) -> None:
        """Forget the plan, not what was seen."""
        self._plan = None
        self.chunks.reset()

    def propose(self, observations: Observations) -> Proposal:
        """Propose what is left of the plan, (1, k, a), or a new one where nothing is."""
        self._past.append(observations)
        if self._plan is None:
            # As LeRobot does: before the first step all looked as in it.
            missing = self.chunks.history - len(self._past)
            shown = [self._past[0]] * missing + list(self._past)
            seed = int(self._rng.integers(2**63)) if self.chunks.draws else 0
            self._plan = self._finished(
                self.chunks.plan([self._seen(each) for each in shown], seed)
            )
        proposed = self._plan
        self._plan = proposed[:, 1:] if proposed.shape[1] > 1 else None
        return Proposal(proposed)

    def predict(self, observations: Observations) -> Proposal:
        """Look at n states: the chunk that would be planned in each, (n, k, a)."""
        return Proposal(self._finished(self.chunks.predict(self._seen(observations))))

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """Return (n,) in 0..1: the largest deviation in a dimension, as a share of its range."""
        return largest_deviations(self.action, proposal.now, labels)

    def _seen(self, observations: Observations) -> Batch:
        shown = self.inputs.batch(observations)
        return self._preprocess({**shown, "task": [self._task] * len(observations)})

    def _finished(self, chunk: torch.Tensor) -> NDArray[np.float32]:
        """(n, k, a) postprocessed, one action a row as LeRobot does it."""
        rows = self._postprocess(chunk.flatten(0, 1)).to("cpu", torch.float32)
        actions = rows.numpy().reshape(*chunk.shape[:2], -1)
        if not self._bounded:
            return actions
        return np.clip(actions, self.action.minimum, self.action.maximum)
