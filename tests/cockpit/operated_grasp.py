"""A grasp that a person at the page operates, in a thread of its own, at the task's pace."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, PersonGate, beside_the_policy
from sheath_manip.cockpit.cockpit import Ending
from sheath_manip.dashboard import Dashboard
from sheath_manip.gates import SupportGate
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.entry import drive_of, hold, teleop
from sheath_manip.tasks.grasp_clutter.scene import EASY
from sheath_manip.tasks.grasp_clutter.task import GraspTask, Scenario
from sheath_manip.types import Actor, EpisodeInfo, Purpose, Step
from tests.cockpit.operated_corridor import AS_ON_A_ROBOT
from tests.judging import ByObservation
from tests.waiting import DEADLINE_S, eventually
from tools.scripted_person import Absent

INFO = EpisodeInfo("grasp-clutter", 5, Purpose.LEARNING, 20.0, method="sheath")
SCENARIO = Scenario(difficulty=EASY, cameras=(), time_limit_s=3600.0)
"""without pictures, and for as long as a browser takes"""
WAIT_S = 3600.0
FALLBACK = "fallback controller “hold”"


@dataclass
class OperatedGrasp:
    """What a test looks at and turns."""

    page: Dashboard
    cockpit: Cockpit
    gate: PersonGate
    inside: bool = True
    """what the gate says"""
    steps: list[Step] = field(default_factory=list)
    turns: list[tuple[float, Actor]] = field(default_factory=list)
    """when, and whose"""
    tool_m: NDArray = field(default_factory=lambda: np.zeros(3))

    def until_turn(self, turn: Actor) -> None:
        """Wait until it is so, in a step that begins from now on."""
        before = len(self.turns)
        assert eventually(lambda: len(self.turns) > before + 1 and self.turns[-1][1] is turn), (
            f"the turn is {self.turns[-1:]}; wanted {turn}"
        )

    @property
    def score(self) -> float:
        return 1.0 if self.inside else -1.0

    def on_fit(self, states) -> None:
        del states

    def on_start(self, environment, info) -> None:
        del environment, info

    def on_step(self, environment, step: Step) -> None:
        del environment
        self.steps.append(step)
        assert step.decision.actor is self.cockpit.turn
        self.turns.append((time.monotonic(), step.decision.actor))
        pose = self.cockpit.tool_pose
        assert pose is not None
        self.tool_m = pose[:3]

    def on_end(self, episode) -> None:
        del episode


@contextmanager
def operated_grasp() -> Iterator[OperatedGrasp]:
    """The run, until the block ends."""
    ready: list[OperatedGrasp] = []
    failed: list[BaseException] = []

    def run() -> None:
        inner = ComposerEnvironment(GraspTask(SCENARIO))
        by_hand = teleop(inner)
        cockpit = Cockpit(by_hand.guide, paced=True, fallback=FALLBACK)
        environment = OperatedEnvironment(inner, cockpit)
        standing = hold(inner)
        try:
            with Dashboard(inner.spec, port=0, cockpit=cockpit) as page:
                inside = SupportGate(ByObservation(lambda _: ready[0].score), 0.0)
                gate = PersonGate(inside, cockpit, 20.0, wait_s=WAIT_S, **AS_ON_A_ROBOT)
                grasp = OperatedGrasp(page, cockpit, gate)
                ready.append(grasp)
                rollout(
                    environment,
                    INFO,
                    gate,
                    rng=np.random.default_rng(0),
                    policy=Absent(drive_of(inner).rest),
                    others=beside_the_policy(cockpit, by_hand, hold=standing, fallback=standing),
                    listeners=(page, grasp, Pacing(times=lambda: cockpit.speed)),
                )
        except BaseException as error:
            failed.append(error)
            raise
        finally:
            inner.close()

    thread = threading.Thread(target=run, name="operated grasp", daemon=True)
    thread.start()
    assert eventually(lambda: bool(failed or (ready and ready[0].steps))), "the run never began"
    assert not failed
    try:
        yield ready[0]
    finally:
        ready[0].cockpit.end(Ending.SAVE)
        ready[0].cockpit.close()
        thread.join(DEADLINE_S)
    assert not thread.is_alive()
    assert not failed
