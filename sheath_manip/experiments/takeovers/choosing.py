"""Which gate is held against the baselines, and at which threshold: chosen on tuning scenes."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.experiments.takeovers.plan import TAKEOVERS, TUNING, GateChoice, Kind
from sheath_manip.experiments.takeovers.trial import (
    Trial,
    mean_share,
    mean_takeovers,
    read_trials,
)
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.files.json_files import write_json


@dataclass(frozen=True)
class Rung:
    """One threshold of one kind of gate, over all policies' tuning scenes that fail alone."""

    level: float
    burden: float
    """takeovers an episode, or the expert's share"""
    failed: float
    """share of the scenes"""


def level_name(level: float) -> str:
    """Return the name of a threshold in files."""
    return f"{level:g}"


def burden_of(axis: str, trials: Sequence[Trial]) -> float:
    """Return what is held equal."""
    return mean_takeovers(trials) if axis == TAKEOVERS else mean_share(trials)


def at_burden(ladder: Sequence[Rung], burden: float) -> tuple[float, float]:
    """Return the level at which a gate asks for `burden`, and the share that it fails there.

    Both are interpolated; beyond the ladder's ends it is the end. But below its least burden the
    share that fails rises towards that of nobody's taking over, which is all: a gate that asks for
    more than it may has no merit of what it does for that.
    """
    levels, burdens, failed = (
        np.array([getattr(rung, name) for rung in ladder]) for name in ("level", "burden", "failed")
    )
    # A burden that falls again with a higher threshold is noise of few scenes.
    burdens = np.maximum.accumulate(burdens)
    burdens = burdens + 1e-9 * np.arange(len(burdens))
    share = np.interp(burden, [0.0, *burdens], [1.0, *failed])
    return float(np.interp(burden, burdens, levels)), float(share)


def choose(policies: Sequence[Watched]) -> dict[str, GateChoice]:
    """Return the gate of each target: of each axis the kind that fails least over its targets."""
    plan = policies[0].plan
    tuned = {kind: _tuned(policies, kind) for kind in plan.kinds}
    if not any(trials for by_level in tuned.values() for trials in by_level.values()):
        raise ParameterError(
            f"no policy of {policies[0].study.name} fails alone on a tuning scene, so there is "
            "nothing to choose a gate by; wanted fewer demonstrations, or more scenes (`most`)"
        )
    chosen: dict[str, GateChoice] = {}
    for axis in dict.fromkeys(axis for axis, _ in plan.targets()):
        values = [value for named, value in plan.targets() if named == axis]
        ladders = {kind: _ladder(axis, of) for kind, of in tuned.items()}
        kind = min(
            ladders, key=lambda name: sum(at_burden(ladders[name], each)[1] for each in values)
        )
        for value in values:
            level, _ = at_burden(ladders[kind], value)
            chosen[target_name(axis, value)] = GateChoice.of(kind, level)
    return chosen


def tuning_table(policies: Sequence[Watched]) -> dict[str, dict[str, list[Rung]]]:
    """Return the ladders by kind and axis, for summaries."""
    plan = policies[0].plan
    return {
        kind.name: {
            axis: _ladder(axis, _tuned(policies, kind))
            for axis in dict.fromkeys(axis for axis, _ in plan.targets())
        }
        for kind in plan.kinds
    }


def target_name(axis: str, value: float) -> str:
    """Return the name of a target in files."""
    return f"{axis}-{value:g}"


def write_choices(path: Path, chosen: Mapping[str, GateChoice]) -> None:
    """Write atomically."""
    write_json(path, {name: asdict(choice) for name, choice in chosen.items()})


def read_choices(path: Path) -> dict[str, GateChoice]:
    """Raises StoreError for a file that holds none."""
    try:
        return {name: GateChoice(**each) for name, each in json.loads(path.read_text()).items()}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise StoreError(
            f"{path} holds no choice of gates ({error}); remove it to have them chosen again"
        ) from error


def _tuned(policies: Sequence[Watched], kind: Kind) -> dict[float, list[Trial]]:
    """All policies' trials on tuning scenes that fail alone, by level."""
    by_level: dict[float, list[Trial]] = {level: [] for level in policies[0].plan.levels_of(kind)}
    for at in policies:
        trials = read_trials(at.trials_path(TUNING, kind.name))
        for level, found in by_level.items():
            found += [trial for trial in trials[level_name(level)] if trial.failing]
    return by_level


def _ladder(axis: str, by_level: Mapping[float, Sequence[Trial]]) -> list[Rung]:
    return [
        Rung(
            level,
            burden_of(axis, trials),
            sum(trial.fails for trial in trials) / max(len(trials), 1),
        )
        for level, trials in by_level.items()
    ]
