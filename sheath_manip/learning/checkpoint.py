"""Policy and gate of one round, in one file.

A support fitted on last round's embedding is meaningless, so they are saved and loaded together.
The file is an .npz of plain arrays with a JSON header: no code is ever loaded from it.
"""

import hashlib
import inspect
import io
import json
import os
import zipfile
import zlib
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import CheckpointError, ParameterError, UnknownNameError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.gates.human import Person
from sheath_manip.gates.making import make_gate
from sheath_manip.learning.older_checkpoints import header_of_schema_2
from sheath_manip.policies import make_policy
from sheath_manip.protocols import Arrays, Gate, TrainablePolicy
from sheath_manip.signals import make_signal
from sheath_manip.types import TaskSpec

FORMAT = "sheath-checkpoint"
SCHEMA = 3
PARTS = ("policy", "signal")
# The earliest date that a zip file can hold: equal content then gives equal bytes.
ZIP_DATE = (1980, 1, 1, 0, 0, 0)
SAMPLED_BYTES = 1 << 16
"""of an array, by which it is told whether compressing it pays"""


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
        """Write the file in one stroke: it is there whole or not at all. Returns its path."""
        path = Path(path)
        fitted = self.fitted
        header = {
            "format": FORMAT,
            "schema": SCHEMA,
            "task": self.task,
            "policy": {"name": self.policy_name, "hyper": _hyperparameters(self.policy)},
            "gate": fitted.config.described(),
            "has_signal": fitted.signal is not None,
            "threshold": fitted.threshold,
            "release_margin": fitted.release_margin,
            "sources": asdict(fitted.sources),
            "method": self.method,
            "round": self.round,
            "run_seed": self.run_seed,
            "training_loss": self.training_loss,
        }
        learned: dict[str, Arrays] = {"policy": self.policy.arrays()}
        if fitted.signal is not None:
            learned["signal"] = fitted.signal.arrays()
        arrays: dict[str, NDArray] = {"header": np.array(json.dumps(header, sort_keys=True))}
        for part, named in learned.items():
            arrays |= {f"{part}/{name}": array for name, array in sorted(named.items())}
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
        try:
            with temporary.open("wb") as file:
                _write_npz(file, arrays)
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
        return path


def load_checkpoint(path: Path | str, spec: TaskSpec) -> Checkpoint:
    """Read a checkpoint of the task `spec`.

    Raises:
        CheckpointError: the file is missing, broken, no checkpoint, of another schema or task, or
            it names a policy, a signal, an embedding or a support that is in no table.
    """
    path = Path(path)
    header, arrays = _read(path)
    if header["task"] != spec.name:
        raise CheckpointError(
            f"{path} was trained on task {header['task']!r}, not on {spec.name!r}; "
            f"use it with task {header['task']}"
        )
    try:
        hyper = dict(header["policy"]["hyper"])
        policy = make_policy(header["policy"]["name"], spec, **hyper).load(arrays["policy"])
        return Checkpoint(
            task=header["task"],
            policy_name=header["policy"]["name"],
            policy=policy,
            fitted=_fitted(header, policy, arrays["signal"]),
            method=str(header["method"]),
            round=int(header["round"]),
            run_seed=int(header["run_seed"]),
            training_loss=float(header["training_loss"]),
        )
    except (UnknownNameError, ParameterError) as error:
        raise CheckpointError(f"{path} does not fit this version or task: {error}") from error
    except (KeyError, TypeError, ValueError) as error:
        raise CheckpointError(f"{path} is broken: {type(error).__name__} {error}") from error


def _fitted(header: dict[str, Any], policy: TrainablePolicy, arrays: Arrays) -> FittedGate:
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
    signal = make_signal(planned_signal(config))
    signal.attach(policy)
    return replace(fitted, signal=signal.load(arrays))


SOURCES = ("fitted_to", "held_out")


def digest(path: Path | str) -> str:
    """16 hex digits, for `EpisodeInfo.checkpoint`: equal for files of equal content."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]
    except OSError as error:
        raise CheckpointError(f"cannot read checkpoint {path}: {error.strerror}") from error


def _hyperparameters(component: Any) -> dict[str, Any]:
    """What its constructor was given: constructors store every argument under its own name."""
    names = inspect.signature(type(component)).parameters
    return {name: getattr(component, name) for name in names if name != "spec"}


def _write_npz(file: Any, arrays: Arrays) -> None:
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, np.asarray(array), allow_pickle=False)
            content = buffer.getvalue()
            info = zipfile.ZipInfo(f"{name}.npy", ZIP_DATE)
            archive.writestr(info, content, _compression(content))


def _compression(content: bytes) -> int:
    """Deflate for what then has half the size at most: binary features have a fiftieth.

    Network weights and image features would not even get a tenth smaller, for a second each.
    """
    sample = content[:SAMPLED_BYTES]
    pays = 2 * len(zlib.compress(sample, 1)) < len(sample)
    return zipfile.ZIP_DEFLATED if pays else zipfile.ZIP_STORED


def _read(path: Path) -> tuple[dict[str, Any], dict[str, dict[str, NDArray]]]:
    if not path.is_file():
        raise CheckpointError(f"no checkpoint at {path}; wanted a file that a training run wrote")
    try:
        # Opened here, since np.load leaves a broken file open.
        with path.open("rb") as file, np.load(file, allow_pickle=False) as content:
            flat = {name: content[name] for name in content.files}
        header = json.loads(str(flat.pop("header", "{}")))
    except OSError as error:
        raise CheckpointError(f"{path} cannot be read as a checkpoint: {error}") from error
    except (ValueError, EOFError, zipfile.BadZipFile, AttributeError, TypeError) as error:
        # numpy's own words advise to unpickle what is foreign.
        raise CheckpointError(
            f"{path} cannot be read as a checkpoint; wanted a file that `sheath train` or an "
            "experiment wrote"
        ) from error
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise CheckpointError(f"{path} is no checkpoint; wanted a file that a training run wrote")
    if header.get("schema") == 2:
        header = header_of_schema_2(path, header)
    if header.get("schema") != SCHEMA:
        raise CheckpointError(
            f"{path} has schema {header.get('schema')}; this version reads 2 and {SCHEMA}: train "
            "again"
        )
    parts: dict[str, dict[str, NDArray]] = {part: {} for part in PARTS}
    for name, array in flat.items():
        part, _, rest = name.partition("/")
        parts.setdefault(part, {})[rest] = array
    return header, parts
