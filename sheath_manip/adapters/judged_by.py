"""The gate of an environment, however it is given, and what it must see beside an action."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.making import make_gate
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.protocols import Gate, PredictingPolicy
from sheath_manip.types import Observation, Proposal, TaskSpec

GateLike = Gate | FittedGate | Checkpoint | Path | str
"""a gate; what was fitted for one; a checkpoint, or the file of one"""


@dataclass(frozen=True, eq=False)
class JudgedBy:
    """A gate, and the policy whose latents it judges by."""

    gate: Gate
    looks: PredictingPolicy | None
    """looks at each observation for the gate; None where a bare action is enough"""


def judged_by(given: GateLike, spec: TaskSpec, looks: PredictingPolicy | None) -> JudgedBy:
    """Return the gate that `given` is or makes.

    What was fitted is tried on an empty scene of the task: where it cannot judge a bare action, the
    policy that it was fitted around looks at each observation, unless another one does.

    Raises CheckpointError for a file that is none of the task, and ParameterError where what was
    fitted cannot judge what `looks` makes of an observation, or `given` is no gate.
    """
    if isinstance(given, str | Path):
        given = load_checkpoint(given, spec)
    if isinstance(given, Checkpoint):
        if given.task != spec.name:
            raise ParameterError(
                f"the checkpoint is of the task {given.task!r}; wanted one of {spec.name!r}"
            )
        given = given.fitted
    if not isinstance(given, FittedGate):
        if not hasattr(given, "decide"):
            raise ParameterError(
                f"a gate of type {type(given).__name__}; wanted a file, a Checkpoint, what "
                "fit_gate gives, or an object with reset(rng) and decide(observation, proposal)"
            )
        return JudgedBy(given, looks)
    gate = make_gate(given)
    if given.signal is None:
        return JudgedBy(gate, looks)
    fault = None
    for one in (None, given.policy) if looks is None else (looks,):
        fault = _judges(given, spec, one)
        if fault is None:
            return JudgedBy(gate, one)
    raise ParameterError(f"the gate cannot judge what that policy sees: {fault}") from fault


def _judges(fitted: FittedGate, spec: TaskSpec, looks: PredictingPolicy | None) -> Exception | None:
    """Let it judge the least action in an empty scene; return why it cannot, None where it can."""
    black = {name: np.zeros((*size, 3), np.uint8) for name, size in spec.cameras.items()}
    empty = Observation(black, np.zeros(len(spec.feature_names), np.float32), 0.0)
    try:
        with np.errstate(all="ignore"):
            latents = {} if looks is None else looks.predict(empty.alone).latents
            fitted.judge(empty, Proposal(spec.action.minimum[None], latents), np.inf)
    except Exception as fault:
        # Readers and policies may come from other packages, and raise what they like.
        return fault
    return None
