"""What crosses a boundary of the loop is checked, and copied so that nobody can change it after."""

from collections.abc import Mapping
from math import isfinite
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ActionError, ObservationError
from sheath_manip.types import (
    ActionSpec,
    Commanded,
    Limited,
    Observation,
    Observations,
    Outcome,
    Proposal,
    TaskSpec,
    Transition,
)
from sheath_manip.types.spec import real_numbers


def kept_observation(observation: Any, spec: TaskSpec) -> Observation:
    """Return a copy that cannot be written to; raises ObservationError where it is none."""
    if not isinstance(observation, Observation):
        raise ObservationError(f"wanted an Observation, got {type(observation).__name__}")
    images = observation.images
    if images.keys() != spec.cameras.keys():
        raise ObservationError(f"wanted the cameras {list(spec.cameras)}, got {list(images)}")
    kept = {
        camera: _kept(f"image of {camera}", images[camera], np.uint8, (*size, 3))
        for camera, size in spec.cameras.items()
    }
    shape = (len(spec.feature_names),)
    features = _kept("features", observation.features, np.float32, shape)
    if not np.isfinite(features).all():
        names = ", ".join(np.array(spec.feature_names)[~np.isfinite(features)])
        raise ObservationError(f"wanted finite features, not so: {names}")
    if not isfinite(_real("time_s", observation.time_s)):
        raise ObservationError(f"wanted a finite time, got {observation.time_s}")
    if not isinstance(observation.instruction, str):
        raise ObservationError(
            f"instruction: wanted a text, got {type(observation.instruction).__name__}"
        )
    return Observation(kept, features, observation.time_s, observation.instruction)


def shown_to_policy(observation: Observation) -> Observations:
    """Return a copy of its own: a policy may scribble on it, as torch wants it to be able to."""
    shown = observation.alone
    images = {camera: image.copy() for camera, image in shown.images.items()}
    return Observations(images, shown.features.copy(), shown.instructions)


def kept_state(state: Any, size: int | None) -> NDArray[np.float64]:
    """Return a copy; raises ObservationError where it is no (size,) float64, or (s,) at first."""
    shape = state.shape if size is None and isinstance(state, np.ndarray) else (size or 0,)
    kept = _kept("state", state, np.float64, shape)
    if kept.ndim != 1:
        raise ObservationError(f"wanted a state of one axis, got the shape {kept.shape}")
    return kept


def kept_transition(transition: Any, spec: TaskSpec) -> Transition:
    """Return a copy that cannot be written to; raises ObservationError, or ActionError."""
    if not isinstance(transition, Transition):
        raise ObservationError(f"wanted a Transition, got {type(transition).__name__}")
    for name, value in (
        ("terminated", transition.terminated),
        ("truncated", transition.truncated),
    ):
        if type(value) is not bool and not isinstance(value, np.bool_):
            raise ObservationError(f"wanted true or false for {name}")
    commanded = transition.commanded
    return Transition(
        kept_observation(transition.observation, spec),
        _real("reward", transition.reward),
        bool(transition.terminated),
        bool(transition.truncated),
        None if commanded is None else _commanded(commanded, spec.action),
    )


def kept_proposal(proposal: Any, spec: ActionSpec) -> Proposal:
    """Return the proposal with the validated action in it: judged is what may be executed.

    Raises ActionError where it proposes no action, and where what the policy saw on its way to it
    is NaN or infinite: then it is no network's opinion, though a choice among actions may come of
    it. That a choice is out of the question is said by -inf.
    """
    if not isinstance(proposal, Proposal):
        raise ActionError(f"wanted a Proposal, got {type(proposal).__name__}")
    try:
        if len(proposal.actions) != 1:
            raise ActionError(f"wanted a proposal for one state, got {len(proposal.actions)}")
        for name, latent in proposal.latents.items():
            if not _has_finite_top(latent):
                raise ActionError(f"the latents {str(name)!r} are not finite")
        first = proposal.actions[0]
        if np.ndim(first) <= 1:
            return Proposal(spec.validated(first)[None], proposal.latents)
        actions = real_numbers(proposal.actions)
        actions[0, 0] = spec.validated(first[0])
    except (AttributeError, IndexError, TypeError, ValueError) as error:
        raise ActionError(f"what is proposed has no shape ({type(error).__name__})") from error
    actions.flags.writeable = False
    return Proposal(actions, proposal.latents)


def kept_outcome(outcome: Any) -> Outcome:
    """Return the outcome; raises ValueError where it is none, or that of an episode cut short."""
    if Outcome(outcome) is Outcome.ERROR:
        raise ValueError("an environment says how the task went: wanted another outcome than error")
    return Outcome(outcome)


def kept_metrics(metrics: Mapping[str, Any]) -> Mapping[str, float]:
    """Return a copy; raises ObservationError where a figure is no number."""
    return {str(name): _real(f"metric {name}", value) for name, value in metrics.items()}


def _kept(what: str, array: Any, dtype: type, shape: tuple[int, ...]) -> NDArray:
    if not isinstance(array, np.ndarray) or array.dtype != dtype or array.shape != shape:
        found = (
            f"{array.dtype} {array.shape}"
            if isinstance(array, np.ndarray)
            else type(array).__name__
        )
        raise ObservationError(f"{what}: wanted {np.dtype(dtype)} {shape}, got {found}")
    kept = np.array(array)
    kept.flags.writeable = False
    return kept


def _real(what: str, value: Any) -> float:
    """A number of Python's or numpy's; text that looks like one is none."""
    if type(value) is float:
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if not isinstance(value, Real | np.bool_):
        raise ObservationError(f"{what}: wanted a number, got {type(value).__name__}")
    return float(value)


def _commanded(commanded: Any, spec: ActionSpec) -> Commanded:
    if not isinstance(commanded, Commanded):
        raise ObservationError(f"wanted a Commanded, got {type(commanded).__name__}")
    action = real_numbers(commanded.action)
    if action.shape != spec.minimum.shape or not np.isfinite(action).all():
        raise ActionError(f"commanded was {action.tolist()}; wanted {spec.minimum.shape} numbers")
    if not all(isinstance(each, Limited) for each in commanded.limited):
        raise ObservationError("wanted limits of the command filter as Limited")
    action.flags.writeable = False
    return Commanded(action, tuple(commanded.limited))


def _has_finite_top(latent: Any) -> bool:
    """Whether the highest number in an array or tensor is finite; there is none beside a NaN."""
    if isinstance(latent, np.ndarray) and latent.dtype.kind not in "fiu":
        return latent.dtype.kind == "b" or not latent.size
    # A tensor has it too: the loop need not know the library.
    highest = getattr(latent, "max", None)
    return highest is None or 0 in latent.shape or isfinite(highest().item())
