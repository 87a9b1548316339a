"""Policy and gate of one round, in one file.

A support fitted on last round's embedding is meaningless, so they are saved and loaded together.
The file is an .npz of plain arrays with a JSON header: no code is ever loaded from it.
"""

import inspect
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Self

from sheath_manip.exceptions import CheckpointError, ParameterError, UnknownNameError
from sheath_manip.files.outputs import written_aside
from sheath_manip.files.plain_files import sha256_of
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.gates.held_out import HeldOut
from sheath_manip.gates.human import Person
from sheath_manip.gates.making import make_gate
from sheath_manip.gates.progress import Progress
from sheath_manip.learning.checkpoint_file import (
    WRITTEN_BY,
    read_arrays,
    require_digest,
    write_arrays,
)
from sheath_manip.learning.checkpoint_header import require_header
from sheath_manip.learning.older_checkpoints import header_of_schema_2
from sheath_manip.learning.trying import require_works
from sheath_manip.policies import make_policy
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.protocols import Arrays, Gate, PredictingPolicy, TrainablePolicy
from sheath_manip.rollout.device import CPU, computes_on
from sheath_manip.signals import make_signal
from sheath_manip.types import TaskSpec

FORMAT = "sheath-checkpoint"
SCHEMA = 4
WITHOUT_DIGEST = (2, 3)
"""older schemas, which are still read"""
EXTERNAL = "external"
"""in place of the name of a policy that is not in the file, which then holds a gate alone"""


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """What one round learned. The parts are shared, not copied: a later refit changes them."""

    task: str
    """name of the task it was trained on"""
    policy_name: str
    policy: TrainablePolicy
    fitted: FittedGate
    """what its gate knows"""
    method: str = ""
    round: int = 0
    run_seed: int = 0
    training_loss: float = float("nan")
    """mean surrogate loss of the policy on the states that it was fitted to"""
    device: str = field(default_factory=computes_on)
    """where it was fitted; it computes where this process does, whichever that was"""
    remark: str = ""
    """what must be told of the file that it was read from; empty where nothing must"""

    @property
    def threshold(self) -> float:
        """The score below which the expert takes over."""
        return self.fitted.threshold

    def with_threshold(self, threshold: float) -> Self:
        """Return the same with another threshold."""
        return replace(self, fitted=replace(self.fitted, threshold=threshold))

    def gate(self, *, person: Person | None = None) -> Gate:
        """Return its gate, with the settings that it was trained with: the only way to one.

        Args:
            person: who may take over where the gate leaves that to a person; nobody where None.
        """
        return make_gate(self.fitted, person=person)

    def save(self, path: Path | str) -> Path:
        """Write the file in one stroke: it is there whole or not at all. Returns its path.

        Raises CheckpointError where a learned number is not finite, and OSError.
        """
        facts = {
            "task": self.task,
            "policy": {"name": self.policy_name, "hyper": _hyperparameters(self.policy)},
            "method": self.method,
            "round": self.round,
            "run_seed": self.run_seed,
            "training_loss": self.training_loss,
            "device": self.device,
        }
        return write_parts(Path(path), facts, self.fitted, {"policy": self.policy.arrays()})


def load_checkpoint(path: Path | str, spec: TaskSpec) -> Checkpoint:
    """Read a checkpoint of the task `spec`.

    Raises:
        CheckpointError: the file is missing, broken, changed, no checkpoint, of another schema or
            task, or it names a policy, a signal, an embedding or a support that is in no table.
    """
    path = Path(path)
    header, arrays, remark = read_parts(path)
    if header["policy"]["name"] == EXTERNAL:
        raise CheckpointError(
            f"{path} holds a gate alone, for a policy that is not in the file; wanted a checkpoint "
            "that `sheath train` wrote, or sheath_manip.load_gate(path, policy) around a loop of "
            "your own: docs/own/frozen-policy.md"
        )
    if header["task"] != spec.name:
        raise CheckpointError(
            f"{path} was trained on task {header['task']!r}, not on {spec.name!r}; "
            f"use it with task {header['task']}"
        )
    try:
        hyper = header["policy"]["hyper"]
        policy = make_policy(header["policy"]["name"], spec, **hyper)
        policy.load(subtree(arrays, "policy"))
        fitted = fitted_in(header, policy, arrays)
        require_works(spec, fitted)
    except (UnknownNameError, ParameterError) as error:
        raise CheckpointError(f"{path} does not fit this version or task: {error}") from error
    except Exception as error:
        # Policies and signals may come from other packages, and raise what they like.
        reason = " ".join(str(error).split())[:300]
        raise CheckpointError(f"{path} is broken: {type(error).__name__} {reason}") from error
    return Checkpoint(
        task=header["task"],
        policy_name=header["policy"]["name"],
        policy=policy,
        fitted=fitted,
        method=header["method"],
        round=header["round"],
        run_seed=header["run_seed"],
        training_loss=float(header["training_loss"]),
        # Before there was a choice it was the CPU.
        device=str(header.get("device", CPU)),
        remark=remark,
    )


def write_parts(
    path: Path, facts: Mapping[str, Any], fitted: FittedGate, learned: Mapping[str, Arrays]
) -> Path:
    """Write a gate, with further `facts` and `learned` arrays, in one stroke; return its path."""
    header = {
        "format": FORMAT,
        "schema": SCHEMA,
        "gate": fitted.config.described(),
        "has_signal": fitted.signal is not None,
        "threshold": fitted.threshold,
        "release_margin": fitted.release_margin,
        "sources": asdict(fitted.sources),
        **facts,
    }
    signal = {} if fitted.signal is None else {"signal": fitted.signal.arrays()}
    if fitted.progress is not None:
        signal |= {"progress": fitted.progress.arrays()}
    if fitted.held_out.episodes:
        signal |= {"held_out": fitted.held_out.arrays()}
    with written_aside(path) as aside, aside.open("wb") as file:
        write_arrays(file, header, flatten({**learned, **signal}))
    return path


def fitted_in(header: Mapping[str, Any], policy: PredictingPolicy, arrays: Arrays) -> FittedGate:
    """Return the gate of `policy` in a file's header and arrays; raises what loading it raises."""
    config = GateConfig.from_described(header["gate"])
    fitted = FittedGate(
        config=config,
        policy=policy,
        threshold=float(header["threshold"]),
        release_margin=float(header["release_margin"]),
        sources=Sources(*(tuple(map(str, header["sources"][name])) for name in SOURCES)),
    )
    if not header["has_signal"]:
        return fitted
    if config.stuck_steps:
        fitted = replace(fitted, progress=Progress.load(subtree(arrays, "progress")))
    fitted = replace(fitted, held_out=HeldOut.load(subtree(arrays, "held_out")))
    signal = make_signal(planned_signal(config))
    signal.attach(policy)
    return replace(fitted, signal=signal.load(subtree(arrays, "signal")))


SOURCES = ("fitted_to", "held_out")


def digest(path: Path | str) -> str:
    """16 hex digits, for `EpisodeInfo.checkpoint`: equal for files of equal content."""
    try:
        return sha256_of(Path(path))[:16]
    except OSError as error:
        raise CheckpointError(
            f"cannot read checkpoint {path}: {error.strerror or error}"
        ) from error


def _hyperparameters(component: Any) -> dict[str, Any]:
    """What its constructor was given: constructors store every argument under its own name."""
    names = inspect.signature(type(component)).parameters
    return {name: getattr(component, name) for name in names if name != "spec"}


def read_parts(path: Path) -> tuple[dict[str, Any], Arrays, str]:
    """Return the header as one of this schema, the arrays, and what must be told of the file.

    Raises CheckpointError where the file is broken or of a schema that is not known.
    """
    header, arrays = read_arrays(path)
    if header.get("format") != FORMAT:
        raise CheckpointError(f"{path} is no checkpoint; wanted {WRITTEN_BY}")
    remark = ""
    if header.get("schema") == SCHEMA:
        require_digest(path, header, arrays)
    elif header.get("schema") in WITHOUT_DIGEST:
        remark = f"{path} has no digest: an older version wrote it, and no changed bit is noticed"
        if header["schema"] == 2:
            header = header_of_schema_2(path, header)
    else:
        raise CheckpointError(
            f"{path} has schema {header.get('schema')!r:.60}; this version reads "
            f"{', '.join(map(str, WITHOUT_DIGEST))} and {SCHEMA}: train again"
        )
    try:
        require_header(header)
    except ValueError as error:
        raise CheckpointError(f"{path} is broken: {error}") from error
    return header, arrays, remark
