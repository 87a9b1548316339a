"""A policy for the gate of a torch module that was trained elsewhere."""

from collections.abc import Callable
from difflib import get_close_matches
from typing import Any, final

import numpy as np
import torch
from numpy.typing import NDArray

from sheath_manip.adapters.from_callable import CallablePolicy, from_callable
from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.choices import likeliest
from sheath_manip.policies.latent import LATENT, SCORES
from sheath_manip.types import ActionSpec, Observations, Proposal


def features_alone(observations: Observations) -> NDArray[np.float32]:
    """Return (n, f) the features."""
    return observations.features


def from_torch(
    module: torch.nn.Module,
    *,
    embed: str | None = None,
    inputs: Callable[[Observations], Any] = features_alone,
    outputs: Callable[[Any], Any] | None = None,
    action: ActionSpec | None = None,
    history: int = 1,
    device: str | torch.device = "cpu",
    reset: Callable[[np.random.Generator], object] | None = None,
) -> CallablePolicy:
    """Return a policy that proposes what `module` answers, in evaluation mode, without gradients.

    Args:
        module: is moved to `device` and put into evaluation mode; nothing else of it is changed.
        embed: name of a layer in `module.named_modules()`, such as `encoder.2`. What comes out of
            it is a latent of the proposal, which the embedding `latent` reads; of a layer that runs
            several times in one look the last. None: embeddings see the observation alone.
        inputs: what the module is called with, of `Observations` of n states: one array or tensor,
            a tuple of them for several arguments, or a dictionary for arguments by name. The
            features alone by default; images are (n, height, width, 3) uint8.
        outputs: makes of what the module returns (n, a) actions or (n, k, a) chunks. By default
            they are that; or, where `action` has choices, the (n, choices) scores of them.
        action: the action space, as `from_callable` takes it.
        history: observations that `inputs` is shown, as `from_callable` takes it.
        device: where the module computes. The CPU is the reference: other devices round otherwise.
        reset: called with a generator at the beginning of each episode.

    Raises ParameterError for a layer that there is none of.
    """
    look = _Look(module.to(device).eval(), embed, inputs, outputs, action, torch.device(device))
    return from_callable(look, batched=True, history=history, action=action, reset=reset)


@final
class _Look:
    """One forward pass, and what a layer gave in it."""

    def __init__(
        self,
        module: torch.nn.Module,
        embed: str | None,
        inputs: Callable[[Observations], Any],
        outputs: Callable[[Any], Any] | None,
        action: ActionSpec | None,
        device: torch.device,
    ) -> None:
        self.module = module
        self.embed = embed
        self.inputs = inputs
        self.outputs = outputs
        self.choices = None if action is None or outputs is not None else action.choices
        self.device = device
        self._layer = None if embed is None else _layer(module, embed)

    @torch.no_grad()
    def __call__(self, observations: Observations) -> Proposal:
        # A module that is trained on would else let dropout decide.
        self.module.eval()
        given: list[Any] = []
        hook = self._layer and self._layer.register_forward_hook(
            lambda _layer, _taken, output: given.append(output)
        )
        try:
            answer = self._forward(self.inputs(observations))
        finally:
            if hook is not None:
                hook.remove()
        latents = {} if self.embed is None else {LATENT: self._latent(given, len(observations))}
        if self.outputs is not None:
            answer = self.outputs(answer)
        actions = _array(answer)
        if self.choices is not None:
            # What signals such as `trust-joined` read beside an embedding.
            latents[SCORES] = actions
            actions = likeliest(self.choices, actions)
        return Proposal(actions, latents)

    def _forward(self, inputs: Any) -> Any:
        if isinstance(inputs, dict):
            return self.module(**{name: self._tensor(each) for name, each in inputs.items()})
        several = inputs if isinstance(inputs, tuple) else (inputs,)
        return self.module(*map(self._tensor, several))

    def _tensor(self, value: Any) -> Any:
        """Arrays as tensors on the device; instructions are text, and stay it."""
        if isinstance(value, np.ndarray):
            # A copy, since what is recorded cannot be written to, which torch warns of.
            value = torch.from_numpy(np.array(value))
        return value.to(self.device) if isinstance(value, torch.Tensor) else value

    def _latent(self, given: list[Any], count: int) -> NDArray[np.float32]:
        if not given:
            raise ParameterError(
                f"the layer {self.embed!r} did not run; wanted one that the module calls in a look"
            )
        last = given[-1]
        latent = last[0] if isinstance(last, tuple | list) and last else last
        if not isinstance(latent, torch.Tensor) or latent.ndim < 1 or len(latent) != count:
            found = tuple(latent.shape) if isinstance(latent, torch.Tensor) else type(last).__name__
            raise ParameterError(
                f"the layer {self.embed!r} gives {found} for {count} states; wanted a tensor "
                "(n, ...), one row a state"
            )
        return _array(latent)


def _layer(module: torch.nn.Module, name: str) -> torch.nn.Module:
    layers = {each: layer for each, layer in module.named_modules() if each}
    if name not in layers:
        near = get_close_matches(name, layers, n=1)
        meant = f"; did you mean {near[0]}?" if near else ""
        raise ParameterError(
            f"the module has no layer {name!r}; wanted one of {', '.join(layers)[:400]}{meant}"
        )
    return layers[name]


def _array(value: Any) -> NDArray[np.float32]:
    if isinstance(value, torch.Tensor):
        return value.detach().to("cpu", torch.float32).numpy()
    return np.asarray(value, np.float32)
