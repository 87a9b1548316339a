"""The gate of a policy that is kept elsewhere, in a file: a checkpoint without the policy."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sheath_manip.dataset.recorded_task import task_of
from sheath_manip.exceptions import CheckpointError, ParameterError, SheathError, UnknownNameError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.learning.checkpoint import (
    EXTERNAL,
    SOURCES,
    fitted_in,
    read_parts,
    write_parts,
)
from sheath_manip.learning.external import (
    External,
    answers_alike,
    answers_of,
    looks_at_made_up,
)
from sheath_manip.learning.loop_gate import LoopGate
from sheath_manip.policies.nested_arrays import subtree
from sheath_manip.protocols import Arrays, PredictingPolicy


@dataclass(frozen=True, eq=False)
class ExternalGate:
    """A gate that was fitted, and what is kept of its policy."""

    fitted: FittedGate
    external: External
    training_loss: float = float("nan")
    """mean surrogate loss of the policy on the states that the gate was fitted to"""

    def answers(self) -> Arrays:
        """Return what the policy is known again by; empty where it answers otherwise each time."""
        readers = self.fitted.readers
        first, again = (
            answers_of(looks_at_made_up(self.fitted.policy, self.external, readers), readers)
            for _ in range(2)
        )
        return first if answers_alike(first, again) else {}

    def save(self, path: Path | str) -> Path:
        """Write the file in one stroke: it is there whole or not at all. Returns its path.

        Raises CheckpointError where a learned number is not finite, and OSError.
        """
        facts = {
            "task": self.external.recorded.task,
            "policy": {"name": EXTERNAL, "hyper": {}},
            "external": self.external.to_json(),
            "method": "",
            "round": 0,
            "run_seed": 0,
            "training_loss": self.training_loss,
        }
        return write_parts(Path(path), facts, self.fitted, {"answers": self.answers()})


@dataclass(frozen=True)
class GateFacts:
    """What the file of a gate tells without its policy."""

    external: External
    config: GateConfig
    threshold: float
    sources: Sources
    knows_policy: bool
    """whether another policy in its place is noticed"""


def gate_facts(path: Path | str) -> GateFacts:
    """Read what the file of a gate tells; raises CheckpointError as `load_gate` does."""
    header, arrays, external = _read(Path(path))
    try:
        config = GateConfig.from_described(header["gate"])
    except (ParameterError, UnknownNameError) as error:
        raise CheckpointError(f"{path} does not fit this version: {error}") from error
    sources = Sources(*(tuple(map(str, header["sources"][name])) for name in SOURCES))
    knows = bool(subtree(arrays, "answers"))
    return GateFacts(external, config, float(header["threshold"]), sources, knows)


def load_gate(path: Path | str, policy: PredictingPolicy) -> LoopGate:
    """Read the gate of `policy` from a file that `sheath gate fit` wrote.

    Args:
        path: of the file.
        policy: the one that it was fitted to, as it was then; `from_callable` and `from_torch` make
            one of a function or module. It is shown a few made-up states to see that it is.

    Raises:
        CheckpointError: the file is missing, broken, changed, or holds no gate of a policy from
            elsewhere; or `policy` is another one than it was fitted to.
    """
    path = Path(path)
    header, arrays, external = _read(path)
    try:
        fitted = fitted_in(header, policy, arrays)
        readers = fitted.readers
        seen = looks_at_made_up(policy, external, readers)
        told = subtree(arrays, "answers")
        if told and not answers_alike(told, answers_of(seen, readers)):
            raise CheckpointError(
                f"{path} is the gate of another policy, or of other weights: in {len(seen)} "
                f"made-up states {external.named!r:.80} gave other answers than the policy given "
                "does; wanted that one, or `sheath gate fit` for this one"
            )
        # Arrays of sizes that do not belong together raise here, and not in the control loop.
        fitted.scores_of(seen)
        return LoopGate(fitted, task_of(external.recorded))
    except CheckpointError:
        raise
    except SheathError as error:
        raise CheckpointError(f"{path} does not fit this version or policy: {error}") from error
    except Exception as error:
        # Policies and signals may come from other packages, and raise what they like.
        reason = " ".join(str(error).split())[:300]
        raise CheckpointError(
            f"{path} does not fit the policy, or is broken: {type(error).__name__} {reason}"
        ) from error


def _read(path: Path) -> tuple[Mapping[str, Any], Arrays, External]:
    header, arrays, _ = read_parts(path)
    policy = header["policy"]
    if policy["name"] != EXTERNAL:
        raise CheckpointError(
            f"{path} is a checkpoint with the policy {policy['name']!r:.80} in it; wanted a gate "
            "that `sheath gate fit` wrote, or sheath_manip.load_checkpoint(path, spec)"
        )
    try:
        if policy["hyper"]:
            raise ValueError("it tells hyperparameters of a policy that it does not hold")
        if not header["has_signal"]:
            raise ValueError("it holds no signal, by which alone a gate could judge")
        return header, arrays, External.from_json(header["task"], header.get("external"))
    except ValueError as error:
        raise CheckpointError(f"{path} is broken: {error}") from error
