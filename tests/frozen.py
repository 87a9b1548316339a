"""A robot of somebody else's: a point that is steered to the middle, its policy, and recordings."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import torch

from sheath_manip.adapters.from_callable import CallablePolicy
from sheath_manip.adapters.from_torch import from_torch
from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.recorded_task import task_of
from sheath_manip.dataset.space import Space
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import Sources
from sheath_manip.learning.external import External
from sheath_manip.learning.frozen import fit_frozen_gate
from sheath_manip.learning.frozen_settings import FROZEN
from sheath_manip.learning.gate_file import ExternalGate
from sheath_manip.types import (
    Action,
    Actor,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Outcome,
    Purpose,
    Reason,
    Step,
)

SPACE = Space(("x_m", "y_m"), ("vx", "vy"), (-1.0, -1.0), (1.0, 1.0), None)
RECORDED = RecordedSpec("point", 20.0, {}, 2, 2, SPACE)
SPEC = task_of(RECORDED)
EXTERNAL = External("mine.py:POLICY", "runs/demos", RECORDED)
STEPS = 25
_ASKED = GateDecision(Actor.EXPERT, True, Reason.FIXED)


def steered(place_m: np.ndarray) -> Action:
    return np.clip(-place_m, -1, 1).astype(np.float32)


def seen(place_m: Any, told: str = "") -> Observation:
    return Observation({}, np.asarray(place_m, np.float32), 0.0, told)


def demonstration(number: int, told: str = "") -> Episode:
    rng = np.random.default_rng(number)
    place_m, steps = rng.uniform(-1, 1, 2), []
    for _ in range(STEPS):
        action = steered(place_m)
        observed = seen(place_m, told)
        steps.append(Step(observed, np.zeros(0), None, action, _ASKED, action, 0.0))
        place_m = place_m + 0.1 * action + rng.normal(0, 0.02, 2)
    info = EpisodeInfo("point", number, Purpose.DEMONSTRATION, 20.0, "expert", index=number)
    return Episode(
        info,
        tuple(steps),
        seen(place_m, told),
        np.zeros(0),
        terminated=True,
        truncated=False,
        outcome=Outcome.SUCCESS,
    )


def module(seed: int = 0) -> torch.nn.Module:
    """Answers nearly as the expert does, through a layer of eight."""
    torch.manual_seed(seed)
    hidden = torch.nn.Linear(2, 8)
    out = torch.nn.Linear(8, 2)
    with torch.no_grad():
        out.weight.copy_(-torch.linalg.pinv(hidden.weight))
        out.bias.copy_(-out.weight @ hidden.bias)
    return torch.nn.Sequential(hidden, out, torch.nn.Hardtanh())


def policy(seed: int = 0, embed: str | None = "0") -> CallablePolicy:
    return from_torch(module(seed), embed=embed, action=SPEC.action)


@cache
def fitted(config: GateConfig = FROZEN, embed: str | None = "0") -> ExternalGate:
    """Fitted once for all tests."""
    fit = fit_frozen_gate(
        policy(embed=embed),
        map(demonstration, range(8)),
        map(demonstration, range(8, 14)),
        config,
        SPEC,
        sources=Sources(("a",), ("b", "c")),
    )
    return ExternalGate(fit.gate, EXTERNAL, fit.training_loss)


def saved(folder: Path) -> Path:
    return fitted().save(folder / "gate.npz")
