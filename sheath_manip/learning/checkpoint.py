"""Policy, signal and threshold of one round, in one file.

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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import CheckpointError, ParameterError, UnknownNameError
from sheath_manip.policies import make_policy
from sheath_manip.protocols import Arrays, Policy, Signal
from sheath_manip.signals import SignalChoice, make_signal
from sheath_manip.signals.joined import JoinedSignal
from sheath_manip.signals.support import SupportSignal
from sheath_manip.types import Observation, Reason, TaskSpec
from sheath_manip.types.samples import Samples

FORMAT = "sheath-checkpoint"
SCHEMA = 2
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
    policy: Policy
    signal_choice: SignalChoice
    signal: Signal
    threshold: float
    """the score below which the expert takes over"""
    false_alarm_rate: float
    """that the threshold was calibrated to, in 0..1"""
    method: str
    round: int
    run_seed: int
    release_margin: float = 0.0
    """>= 0, how far above the threshold a score must be for the expert to hand back"""

    def score(self, observation: Observation) -> float:
        """The signal's score of one observation; NaN where it has none."""
        images = {camera: image[None] for camera, image in observation.images.items()}
        return float(self.signal.scores(images, observation.features[None])[0])

    def reason(self, observation: Observation) -> Reason:
        """What is to blame for a score below the threshold: the state, or the proposed action."""
        images = {camera: image[None] for camera, image in observation.images.items()}
        if isinstance(self.signal, JoinedSignal):
            parts = self.signal.parts(images, observation.features[None])
            # Who finds it rarest, however often each counts.
            weights = self.signal.weights
            rarest = min(parts, key=lambda name: float(parts[name][0]) / weights[name])
            return Reason.OUTSIDE if rarest == "support" else Reason.RISK
        return Reason.OUTSIDE if isinstance(self.signal, SupportSignal) else Reason.RISK

    def scores(self, samples: Samples) -> NDArray[np.float64]:
        """(n,) the signal's scores of `samples`."""
        return self.signal.scores(samples.images, samples.features)

    def save(self, path: Path | str) -> Path:
        """Write the file in one stroke: it is there whole or not at all. Returns its path."""
        path = Path(path)
        header = {
            "format": FORMAT,
            "schema": SCHEMA,
            "task": self.task,
            "policy": {"name": self.policy_name, "hyper": _hyperparameters(self.policy)},
            "signal": asdict(self.signal_choice),
            "threshold": self.threshold,
            "release_margin": self.release_margin,
            "false_alarm_rate": self.false_alarm_rate,
            "method": self.method,
            "round": self.round,
            "run_seed": self.run_seed,
        }
        arrays: dict[str, NDArray] = {"header": np.array(json.dumps(header, sort_keys=True))}
        for part in PARTS:
            learned: Arrays = getattr(self, part).arrays()
            arrays |= {f"{part}/{name}": array for name, array in sorted(learned.items())}
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


def with_policy(checkpoint: Checkpoint, policy: Policy) -> Checkpoint:
    """Another `policy` under the gate of `checkpoint`, whose signal then looks through that one.

    Only for where nothing depends on the gate: what it was fitted to are the old policy's states.
    """
    signal = make_signal(checkpoint.signal_choice).load(policy, checkpoint.signal.arrays())
    return replace(checkpoint, policy=policy, signal=signal)


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
        choice = SignalChoice(**header["signal"])
        return Checkpoint(
            task=header["task"],
            policy_name=header["policy"]["name"],
            policy=policy,
            signal_choice=choice,
            signal=make_signal(choice).load(policy, arrays["signal"]),
            threshold=float(header["threshold"]),
            false_alarm_rate=float(header["false_alarm_rate"]),
            method=str(header["method"]),
            round=int(header["round"]),
            run_seed=int(header["run_seed"]),
            # Files from before there was one have none.
            release_margin=float(header.get("release_margin", 0.0)),
        )
    except (UnknownNameError, ParameterError) as error:
        raise CheckpointError(f"{path} does not fit this version or task: {error}") from error
    except (KeyError, TypeError, ValueError) as error:
        raise CheckpointError(f"{path} is broken: {type(error).__name__} {error}") from error


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
    if header.get("schema") != SCHEMA:
        raise CheckpointError(
            f"{path} has schema {header.get('schema')}; this version reads {SCHEMA}: train again"
        )
    parts: dict[str, dict[str, NDArray]] = {part: {} for part in PARTS}
    for name, array in flat.items():
        part, _, rest = name.partition("/")
        parts.setdefault(part, {})[rest] = array
    return header, parts
