"""How each kind of LeRobot policy makes a chunk of actions of what it sees."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, final

import torch

Batch = Mapping[str, Any]
"""tensors by LeRobot's names, (n, ...), after the policy's own preprocessing"""


class Chunks(Protocol):
    """One forward pass, by the policy's own methods; what it gives is not postprocessed yet."""

    history: int
    """h, the observations that it looks at: the present one and those before it"""
    draws: bool
    """whether what it plans depends on a seed"""

    def reset(self) -> None:
        """Forget what was planned before."""
        ...

    def plan(self, seen: Sequence[Batch], seed: int) -> torch.Tensor:
        """(n, k, a) the actions to be executed from now on, of h batches, the oldest first."""
        ...

    def predict(self, seen: Batch) -> torch.Tensor:
        """(n, k, a) what would be planned where all before looked as now; nothing is kept."""
        ...


@final
class ActChunks:
    """ACT's (Zhao et al. 2023): a chunk at once, or each step one of the mean of past chunks."""

    history = 1
    draws = False

    def __init__(self, policy: Any) -> None:
        self.policy = policy

    def reset(self) -> None:
        """Forget past chunks."""
        self.policy.reset()

    def plan(self, seen: Sequence[Batch], seed: int) -> torch.Tensor:
        """(n, k, a) with the k that the config says to execute of each chunk."""
        del seed
        if self.policy.config.temporal_ensemble_coeff is None:
            return self.predict(seen[-1])
        chunk = self.policy.predict_action_chunk(dict(seen[-1]))
        return self.policy.temporal_ensembler.update(chunk)[:, None]

    def predict(self, seen: Batch) -> torch.Tensor:
        """(n, k, a)."""
        chunk = self.policy.predict_action_chunk(dict(seen))
        return chunk[:, : self.policy.config.n_action_steps]


@final
class DiffusionChunks:
    """Diffusion Policy's (Chi et al. 2023): drawn anew for each chunk, by a seed."""

    draws = True

    def __init__(self, policy: Any) -> None:
        self.policy = policy
        self.history = int(policy.config.n_obs_steps)

    def reset(self) -> None:
        """Return at once: what it looks back at is handed to it."""
        return

    @torch.no_grad()
    def plan(self, seen: Sequence[Batch], seed: int) -> torch.Tensor:
        """(n, k, a) with the k that the config says to execute of each chunk."""
        together = [self._images_together(each) for each in seen]
        stacked = {
            name: torch.stack([each[name] for each in together], dim=1)
            for name in together[0]
            if name.startswith("observation.")
        }
        device = stacked["observation.state"].device
        # Its scheduler draws from torch's own generator, which nobody else shall find moved.
        with torch.random.fork_rng(devices=[device] if device.type == "cuda" else []):
            torch.manual_seed(seed)
            return self.policy.diffusion.generate_actions(stacked)

    def predict(self, seen: Batch) -> torch.Tensor:
        """(n, k, a), always by the same seed."""
        return self.plan([seen] * self.history, seed=0)

    def _images_together(self, seen: Batch) -> dict[str, torch.Tensor]:
        """The vectors as they are, and all cameras as one (n, cameras, 3, h, w)."""
        cameras = list(self.policy.config.image_features)
        together = {name: value for name, value in seen.items() if name not in cameras}
        if cameras:
            together["observation.images"] = torch.stack([seen[name] for name in cameras], dim=1)
        return together


CHUNKS: Mapping[str, type[ActChunks | DiffusionChunks]] = {
    "act": ActChunks,
    "diffusion": DiffusionChunks,
}
"""by the `type` in a policy's config"""
