"""What page and control loop share: who is at the page changes it, the loop looks at each step."""

import math
import threading
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit import transitions
from sheath_manip.cockpit.between import Between
from sheath_manip.cockpit.lease import LOST_AFTER_S, Axes, Lease
from sheath_manip.cockpit.orders import Order
from sheath_manip.cockpit.question import Question
from sheath_manip.cockpit.shown import NOTHING, Shown
from sheath_manip.cockpit.standing import Ending, Now, Standing
from sheath_manip.cockpit.state import State
from sheath_manip.protocols import Environment, Holds
from sheath_manip.rollout.watch import waiting_on_purpose
from sheath_manip.types import Actor, Outcome
from sheath_manip.types.operator_input import EMPTY, Binding, OperatorInput, SixAxes

_GLANCE_S = 0.02
"""between two looks at how things stand while the run stands still"""

__all__ = ["Cockpit", "Ending", "Now", "State"]


class Cockpit:
    """Takes what a person orders and does, and hands it to the control loop step by step.

    An order acts in the very call that gives it, under one lock, whatever the loop does meanwhile:
    `transitions` says what it makes of how things stand. The page's side may be called from any
    thread and returns at once; the loop's side belongs to the thread of the control loop.
    """

    def __init__(
        self,
        guide: tuple[Binding, ...] = (),
        clock: Callable[[], float] = time.monotonic,
        paced: bool = False,
        fallback: str = State.fallback,
        planar: bool = False,
        undo_s: float = transitions.UNDO_S,
        standing: Standing | None = None,
    ) -> None:
        """Begin with a run that goes on, at the task's own pace.

        Args:
            guide: the keys by which a person drives; without any the run may only be held.
            clock: seconds that never go back.
            paced: whether the loop keeps to `speed`.
            fallback: who acts where a person is asked and does not come, in words.
            planar: whether what a gizmo moves stays level and at its height.
            undo_s: in which a discard may be called off.
            standing: how things stand already; None: nobody has ordered anything yet.
        """
        self.guide = guide
        self.paced = paced
        self.planar = planar
        self.on_change: Callable[[], None] = lambda: None
        """called, on any thread, where there is something new to show; returns at once"""
        self._clock = clock
        self._undo_s = undo_s
        self._news = threading.Condition()
        self._standing = standing or Standing(operated=bool(guide))
        self.between = Between(clock)
        """what is done while no episode runs"""
        self._axes: Axes | None = None
        self._acting = State(operated=bool(guide), fallback=fallback)
        """the loop's part of what the page shows: turn, asking, left_s, may_go_on"""
        self.input = EMPTY
        """what the person's devices said in this step"""
        self.tool_pose: NDArray[np.float64] | None = None
        """(7,) position (m) and wxyz quaternion, world frame, where the robot has a tool"""
        self.question: Question | None = None
        """what the gate has just decided against; None where it lets the policy act"""
        self.gated = False
        """whether the episode's gate goes by the person's orders; else its environment does"""
        self.still = False
        """whether nothing moves in this step, since the simulation cannot hold"""

    # The page's side.
    @property
    def state(self) -> State:
        """The cockpit as it is now."""
        standing, now_s = self._seen(), self._clock()
        return replace(
            self._acting,
            paused=standing.paused,
            speed=standing.speed,
            stopped=standing.stopped,
            stops=standing.stops,
            episode=standing.episodes,
            taken=standing.taken,
            abandoned=standing.abandoned,
            unready=standing.unready,
            between=self.between.now,
            discard_s=standing.discard_in_s(now_s),
            over=standing.closed,
            operator=standing.lease.holder,
        )

    @property
    def true_s(self) -> float:
        """Up to when what is known of the loop is true: of one in this program always."""
        return math.inf

    @property
    def paused(self) -> bool:
        """Whether the person holds the run."""
        return self._standing.paused

    @property
    def lease(self) -> Lease:
        """Who drives."""
        return self._seen().lease

    @property
    def latest_input(self) -> OperatorInput:
        """What the operator's page said last."""
        return self._seen().lease.input or EMPTY

    def order(
        self,
        order: Order,
        station: str | None,
        value: float = 1.0,
        shown: Shown = NOTHING,
    ) -> bool:
        """Do what `station` orders; whether it may. None is the program, which nobody locks out.

        While somebody drives only that one gives orders, but for the emergency stop.
        """
        now_s = self._clock()
        return self._follow(
            lambda now: transitions.follow(now, order, station, now_s, value, shown, self._undo_s)
        )

    def submit_input(self, station: str, operator_input: OperatorInput, age_s: float = 0.0) -> bool:
        """Take what the devices of `station` said `age_s` ago, a heartbeat too; whether it drives.

        What is too old to go by is not heard.
        """
        if age_s > LOST_AFTER_S:
            return self.lease.holder == station
        at_s = self._clock() - age_s
        return self._hear(
            lambda standing: transitions.heard(standing, station, operator_input, at_s)
        )

    def drag(self, station: str, goal: NDArray | None) -> bool:
        """Take where `station` drags the gizmo to, (7,), or None once it lets go of it."""
        copied = None if goal is None else np.array(goal, np.float64)
        return self._hear(lambda standing: transitions.dragged(standing, station, copied))

    def turn_axes(self, axes: SixAxes) -> None:
        """Take what a device says that is plugged in here; it drives where a station does."""
        self._axes = Axes(self._clock(), axes)

    def silence(self, station: str) -> None:
        """Make nothing that `station` said count until it is heard again."""
        self._follow(lambda standing: transitions.silenced(standing, station))

    def leave(self, station: str) -> None:
        """`station` is gone."""
        self._follow(lambda standing: transitions.left(standing, station))

    # For the program that runs the loop.

    def pause(self) -> None:
        """Hold the run at its next step."""
        self.order(Order.PAUSE, station=None)

    def resume(self) -> None:
        """Let it go on; not where it is stopped."""
        self.order(Order.RESUME, station=None)

    def end(self, ending: Ending) -> None:
        """End the episode at its next step."""
        self._follow(lambda standing: replace(standing, ending=ending))

    def close(self) -> None:
        """Never wait again."""
        self._follow(lambda standing: replace(standing, closed=True))

    # The loop's side.

    def begin_episode(self) -> None:
        """Forget how the last one was ended; who drives drives on, and who holds goes on so."""
        self._follow(transitions.begun)
        self.question = None
        self.gated = False
        self.give_turn(Actor.POLICY)

    def await_ready(self) -> None:
        """Wait until a person takes over or lets the policy begin, or until the page is gone."""
        self._follow(lambda now: replace(now, unready=not now.taken, abandoned=not now.taken))
        while (now := self.now()).abandoned and not now.closed:
            self.give_turn(Actor.HOLD, asking=True, left_s=math.inf, still=True)
            self.rest()
        self._follow(lambda standing: replace(standing, unready=False))

    @property
    def ending(self) -> Ending | None:
        """How the person ends the episode, once it was said and cannot be called off."""
        return self._seen().ending

    @property
    def discarding(self) -> bool:
        """Whether the episode is about to be discarded."""
        return self._seen().discard_at_s is not None

    @property
    def mark(self) -> Outcome | None:
        """What the person said the episode is, if anything."""
        return None if self.ending is None else self.ending.outcome

    @property
    def speed(self) -> float:
        """Times the task's own pace."""
        return self._standing.speed

    @property
    def turn(self) -> Actor:
        """Who acts in this step."""
        return self._acting.turn

    @property
    def closed(self) -> bool:
        """Whether the page is gone, so that nobody will ever answer."""
        return self._standing.closed

    def now(self) -> Now:
        """Return what this step goes by, all of one moment."""
        with self._news:
            now_s = self._clock()
            standing = transitions.aged(self._standing, now_s)
            if standing.halted and not standing.stopped:
                standing = transitions.let_on(standing) or standing
            news = standing.abandoned is not self._standing.abandoned
            self._standing = standing
        if news:
            self.on_change()
        operator_input = standing.lease.everything(now_s, self._axes)
        self.input = operator_input or EMPTY
        return Now.of(standing, operator_input)

    def give_turn(
        self,
        turn: Actor,
        asking: bool = False,
        left_s: float = 0.0,
        still: bool = False,
        may_go_on: bool = True,
    ) -> None:
        """Say who acts in this step, whether the robot asks, and whether the policy may go on."""
        before = self._acting
        self.still = still
        self._acting = replace(before, turn=turn, asking=asking, left_s=left_s, may_go_on=may_go_on)
        if (before.turn, before.asking, before.may_go_on) != (turn, asking, may_go_on):
            self.on_change()

    def wait(self, environment: Environment | None = None) -> None:
        """Return at once, or as soon as the run may go on; the environment holds its robot then."""
        waits = False
        while not (self._hear(transitions.let_on) or self.closed or self.ending is not None):
            if not waits and isinstance(environment, Holds):
                environment.hold()
            waits = True
            self.rest()

    def rest(self) -> float:
        """Wait for news, but not for long; seconds that it took."""
        began_s = self._clock()
        with waiting_on_purpose(), self._news:
            self._news.wait(_GLANCE_S)
        return self._clock() - began_s

    def _seen(self) -> Standing:
        return transitions.aged(self._standing, self._clock())

    def _hear(self, transition: Callable[[Standing], Standing | None]) -> bool:
        """Whether `transition` applies; nobody is woken, since heartbeats come all the time."""
        with self._news:
            before = transitions.aged(self._standing, self._clock())
            after = transition(before)
            self._standing = after or before
        return after is not None

    def _follow(self, transition: Callable[[Standing], Standing | None]) -> bool:
        """The same of what the page shows, and the loop waits for."""
        if not self._hear(transition):
            return False
        with self._news:
            self._news.notify_all()
        self.on_change()
        return True
