"""Explains the moment that a page shows, on a thread of its own: never on the control loop's."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sheath_manip.cockpit.question import Question
from sheath_manip.dashboard.explaining import Example, Explanation, Moment, did, explained
from sheath_manip.dashboard.ghost import Ghost, Simulation, ghosts, state_after
from sheath_manip.dashboard.reference import GateReference
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.exceptions import CheckpointError
from sheath_manip.protocols import Environment, Holds
from sheath_manip.types import Action, Actor, EpisodeInfo, Step, TaskSpec

EXAMPLES = 3
MakeEnvironment = Callable[[EpisodeInfo], Environment]


@dataclass(frozen=True, eq=False)
class Wish:
    """What is to be explained."""

    key: tuple[object, ...]
    """the same for the same moment"""
    info: EpisodeInfo
    moment: Moment
    before: tuple[np.ndarray, Action | None] | None
    """a state, and what was executed from there to come to the moment, if anything; None where the
    environment has no state"""


@dataclass(frozen=True, eq=False)
class Explained:
    """One moment, explained; what takes longer is added to it once it is there."""

    key: tuple[object, ...]
    explanation: Explanation
    ghosts: tuple[Ghost, ...] = ()
    """of what is proposed, then of what the expert would do, where that is known"""


@dataclass
class _Workshop:
    """What one worker has made for itself: an environment belongs to the thread that made it."""

    environment: Any = None
    scene: tuple[str, int] | None = None
    seed: int | None = None
    closing: bool = False


class Explainer:
    """Takes the latest wish, and forgets those in between."""

    def __init__(
        self,
        spec: TaskSpec,
        load: Callable[[], GateReference] | None = None,
        make: MakeEnvironment | None = None,
    ) -> None:
        """Explain by what a step has recorded, and by more where it is there.

        Args:
            spec: of the task.
            load: the gate and what it was fitted to; called once, on the explainer's thread.
            make: an environment of an episode's scene, for ghosts; called on that thread, only for
                episodes whose recorded states show that they are of a simulation.
        """
        self._spec, self._load, self._make = spec, load, make
        self.on_change: Callable[[], None] = lambda: None
        """called where there is something new to show; returns at once"""
        self.question: Callable[[], Question | None] = lambda: None
        """what a run stands still before, if it does"""
        self.latest: Explained | None = None
        self._wanted: Wish | None = None
        self._key: tuple[object, ...] | None = None
        self._news = threading.Condition()
        self._reference: GateReference | None = None
        self._failure = ""
        self._workshop: _Workshop | None = None

    @property
    def compares(self) -> bool:
        """Whether it knows the gate, and so what that compares with."""
        return self._load is not None

    def ask(self, snapshot: Snapshot) -> Explained | None:
        """Have what `snapshot` shows explained soon; returns what is known of it by now."""
        return self.wish(wish_of(snapshot, self.question()))

    def wish(self, wish: Wish | None) -> Explained | None:
        """Have `wish` explained soon; returns what is known of that very moment by now."""
        with self._news:
            key = None if wish is None else wish.key
            if key != self._key:
                self._key, self._wanted = key, wish
                if wish is not None and self._workshop is None:
                    self._workshop = _Workshop()
                    threading.Thread(
                        target=self._work, args=(self._workshop,), name="explainer", daemon=True
                    ).start()
                self._news.notify()
            latest = self.latest
        return latest if latest is not None and latest.key == key else None

    def close(self) -> None:
        """End the worker after what is under way; another wish begins another one."""
        with self._news:
            if self._workshop is not None:
                self._workshop.closing = True
            self._workshop = self._wanted = self._key = None
            self._news.notify_all()

    def _work(self, workshop: _Workshop) -> None:
        while True:
            with self._news:
                while self._wanted is None and not workshop.closing:
                    self._news.wait()
                if workshop.closing:
                    break
                wish, self._wanted = self._wanted, None
            assert wish is not None
            found = Explained(wish.key, self._explained(wish))
            self._show(found)
            # A ghost takes some steps of a simulation: what is known already is shown before.
            if wish.before is not None and self._wanted is None:
                self._show(replace(found, ghosts=self._ghosts(wish, workshop)))
        if workshop.environment is not None:
            workshop.environment.close()

    def _show(self, found: Explained) -> None:
        self.latest = found
        self.on_change()

    def _explained(self, wish: Wish) -> Explanation:
        moment, spec, lacks = wish.moment, self._spec.action, ""
        precedents, examples, steps = None, (), 0
        try:
            reference = self._referred()
            if reference is None:
                lacks = "The states that the gate compares with are not known here."
            elif moment.proposed is not None:
                steps = reference.held_out_steps
                precedents = reference.precedents(moment.observation, moment.proposed)
                if precedents is None:
                    lacks = "This gate compares with no single states, so there are none to show."
                else:
                    lacks = reference.lacks_of(precedents)
                    examples = _examples(reference, precedents, self._spec)
        except Exception as error:
            # A policy of others may raise what it likes, and of a worker nobody else would hear.
            lacks = f"No comparison: {type(error).__name__}: {error}"
        sentence, rang = explained(moment, spec, precedents, steps)
        return Explanation(sentence, rang, moment, precedents, examples, lacks)

    def _referred(self) -> GateReference | None:
        if self._reference is None and self._load is not None:
            if self._failure:
                raise CheckpointError(self._failure)
            try:
                self._reference = self._load()
            except Exception as error:
                # Not read again at every moment.
                self._failure = str(error)
                raise
        return self._reference

    def _ghosts(self, wish: Wish, workshop: _Workshop) -> tuple[Ghost, ...]:
        moment, make = wish.moment, self._make
        if make is None or wish.before is None or moment.proposed is None:
            return ()
        actions = [each for each in (moment.proposed, moment.labelled) if each is not None]
        try:
            simulation = _simulation(workshop, wish.info, make)
            # What brings a robot to rest by itself may have one behind it, which nobody may move.
            if not isinstance(simulation, Simulation) or isinstance(simulation, Holds):
                return ()
            state, executed = wish.before
            if executed is not None:
                state = state_after(simulation, state, executed)
            return tuple(ghosts(simulation, state, actions))
        except Exception:
            # An action that the simulation refuses has no ghost; the rest is still explained.
            return ()


def wish_of(snapshot: Snapshot, question: Question | None) -> Wish | None:
    """Return what a person who looks at `snapshot` would ask about; None where nothing is to ask.

    That is `question`, where the run stands still before a step; the step that is looked at, where
    the page stands; else the first step of the turn under way, in which the policy does not act.
    """
    if question is not None and snapshot.present:
        moment = Moment(question.observation, question.proposed, None, question.decision)
        last = snapshot.step
        before = None if last is None or not last.state.size else (last.state, last.requested)
        return Wish((question,), snapshot.info, moment, before)
    at = _step_in_question(snapshot)
    if at is None or snapshot.step is None:
        return None
    step = snapshot.steps[at]
    # A simulation beside a control loop that is at work would hold it up.
    stands = snapshot.paused or not snapshot.present or snapshot.step.decision.actor is Actor.HOLD
    before = (step.state, None) if step.state.size and stands else None
    # By the film and not by its info: a scene that is run again is another episode.
    key = (id(snapshot.steps), at, before is not None)
    return Wish(key, snapshot.info, _moment(step), before)


def _step_in_question(snapshot: Snapshot) -> int | None:
    if snapshot.step is None:
        return None
    if snapshot.paused:
        return snapshot.at if _is_judged(snapshot.step) else None
    for start, stop in reversed(snapshot.trace.turns):
        if start <= snapshot.at < stop:
            return start
    return None


def _is_judged(step: Step) -> bool:
    decision = step.decision
    return step.proposed is not None or bool(decision.signals) or bool(decision.broken)


def _moment(step: Step) -> Moment:
    return Moment(step.observation, step.proposed, step.labelled, step.decision)


def _examples(reference: GateReference, precedents: Any, spec: TaskSpec) -> tuple[Example, ...]:
    return tuple(
        Example(
            float(precedents.distances[place]),
            did(spec.action, precedents.labels[place]),
            reference.image(precedents, place),
        )
        for place in range(min(EXAMPLES, len(precedents.labels)))
    )


def _simulation(workshop: _Workshop, info: EpisodeInfo, make: MakeEnvironment) -> Environment:
    """An environment in the scene of an episode, made anew only for another one."""
    scene = info.variant, info.run_seed
    if workshop.environment is None or workshop.scene != scene:
        if workshop.environment is not None:
            workshop.environment.close()
        workshop.environment, workshop.scene, workshop.seed = make(info), scene, None
    if workshop.seed != info.seed:
        workshop.environment.reset(info.seed)
        workshop.seed = info.seed
    return workshop.environment
