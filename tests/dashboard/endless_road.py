"""A run on the ring road that goes on until there was enough, on a thread of its own."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit import Cockpit
from sheath_manip.controllers.hold import Hold
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.widgets.nu import NuSlider
from sheath_manip.dashboard.widgets.what_if import WhatIf
from sheath_manip.gates.adjustable import Adjustable, Boundary, Dial
from sheath_manip.gates.support import SupportGate
from sheath_manip.protocols import Gate
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.types import Action, Actor, EpisodeInfo, Purpose, Transition
from sheath_manip.types.operator_input import Binding
from tests.dashboard.conftest import SPEC, TOKEN, RingRoad
from tests.judging import always
from tests.waiting import DEADLINE_S
from tools.scripted_person import Absent

INFO = EpisodeInfo(SPEC.name, 1, Purpose.LEARNING, SPEC.control_rate_hz, method="sheath")


class EndlessRoad(RingRoad):
    """Until there was enough."""

    def __init__(self) -> None:
        super().__init__()
        self.enough = threading.Event()

    def step(self, action: NDArray[np.float32]) -> Transition:
        return replace(super().step(action), truncated=self.enough.is_set())


def straight_on() -> Action:
    return np.zeros(1, np.float32)


@contextmanager
def driven(dashboard: Dashboard, gate: Gate) -> Iterator[None]:
    """While the block runs, so does an episode under that gate, at its pace."""
    environment = EndlessRoad()

    def run_episode() -> None:
        rollout(
            environment,
            INFO,
            gate,
            rng=np.random.default_rng(0),
            policy=Absent(straight_on),
            expert=Hold(straight_on),
            listeners=(dashboard, Pacing()),
        )

    run = threading.Thread(target=run_episode, daemon=True)
    run.start()
    yield
    environment.enough.set()
    run.join(DEADLINE_S)
    assert not run.is_alive()


@dataclass(frozen=True)
class Dialled:
    """A run whose gate a person may adjust."""

    dashboard: Dashboard
    cockpit: Cockpit
    fitted: list[tuple[float, str]]
    """with which ν a support was fitted anew, and on which thread"""

    def acts(self, actor: Actor, threshold: float) -> bool:
        """Whether the latest step was so decided."""
        snapshot = self.dashboard._latest()
        decision = snapshot.step.decision if snapshot and snapshot.step else None
        return decision is not None and (decision.actor, decision.threshold) == (actor, threshold)


@contextmanager
def dialled() -> Iterator[Dialled]:
    """The run: all steps score 0.5 against a threshold of 0, or -2 once the support is refitted."""
    dial = Dial(Boundary(always(0.5), threshold=0.0, lowest=-1.0, highest=1.0))
    fitted: list[tuple[float, str]] = []

    def refit(nu: float) -> Boundary:
        fitted.append((nu, threading.current_thread().name))
        return Boundary(always(-2.0), threshold=-0.5, lowest=-3.0, highest=3.0)

    gate = (
        partial(WhatIf, dial=dial),
        partial(NuSlider, dial=dial, refit=refit, nu=0.1),
    )
    cockpit = Cockpit((Binding(("KeyI",), "on"),))
    with (
        Dashboard(SPEC, port=0, token=TOKEN, cockpit=cockpit, gate=gate) as dashboard,
        driven(dashboard, Adjustable(SupportGate(always(0.5), 0.0), dial)),
    ):
        yield Dialled(dashboard, cockpit, fitted)
