"""Explains the moment that a page shows, on a thread of its own: never on the control loop's."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from sheath_manip.cockpit.question import Question
from sheath_manip.dashboard.explaining import Example, Explanation, Moment, did, explained
from sheath_manip.dashboard.ghost import Ghost, Simulation, ghosts, state_after
from sheath_manip.dashboard.reference import GateReference
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.protocols import Environment
from sheath_manip.types import Action, EpisodeInfo, Step, TaskSpec

EXAMPLES = 3
MakeEnvironment = Callable[[EpisodeInfo], Environment]


@dataclass(frozen=True, eq=False)
class Wish:
    """What is to be explained."""

    key: tuple[object, int]
    """the same for the same moment"""
    info: EpisodeInfo
    moment: Moment
    before: tuple[np.ndarray, Action | None] | None
    """a state, and what was executed from there to come to the moment, if anything; None where the
    environment has no state"""


@dataclass(frozen=True, eq=False)
class Explained:
    """One moment, explained; what takes longer is added to it once it is there."""

    key: tuple[object, int]
    explanation: Explanation
    ghosts: tuple[Ghost, ...] = ()
    """of what is proposed, then of what the expert would do, where that is known"""


@dataclass
class _Workshop:
    """What the worker has made for itself."""

    reference: GateReference | None = None
    failure: str = ""
    environment: Any = None
    scene: tuple[str, int] | None = None
    seed: int | None = None
    gone: bool = False
    lock: threading.Lock = field(default_factory=threading.Lock)


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
        self._key: tuple[object, int] | None = None
        self._news = threading.Condition()
        self._workshop = _Workshop()
        self._thread: threading.Thread | None = None

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
                if wish is not None and self._thread is None:
                    self._thread = threading.Thread(
                        target=self._work, name="explainer", daemon=True
                    )
                    self._thread.start()
                self._news.notify()
            latest = self.latest
        return latest if latest is not None and latest.key == key else None

    def close(self) -> None:
        """End after what is under way."""
        with self._news:
            self._workshop.gone = True
            self._news.notify()

    def _work(self) -> None:
        while True:
            with self._news:
                while self._wanted is None and not self._workshop.gone:
                    self._news.wait()
                if self._workshop.gone:
                    break
                wish, self._wanted = self._wanted, None
            assert wish is not None
            found = Explained(wish.key, self._explained(wish))
            self._show(found)
            # A ghost takes some steps of a simulation: what is known already is shown before.
            if wish.before is not None and self._wanted is None:
                self._show(replace(found, ghosts=self._ghosts(wish)))
        if self._workshop.environment is not None:
            self._workshop.environment.close()

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
                lacks = reference.lacks
                if precedents is None:
                    lacks = "This gate compares with no single states, so there are none to show."
                else:
                    examples = _examples(reference, precedents, self._spec)
        except Exception as error:
            # A policy of others may raise what it likes, and of a worker nobody else would hear.
            lacks = f"No comparison: {type(error).__name__}: {error}"
        sentence, rang = explained(moment, spec, precedents, steps)
        return Explanation(sentence, rang, moment, precedents, examples, lacks)

    def _referred(self) -> GateReference | None:
        workshop = self._workshop
        if workshop.reference is None and self._load is not None:
            if workshop.failure:
                raise RuntimeError(workshop.failure)
            try:
                workshop.reference = self._load()
            except Exception as error:
                workshop.failure = str(error)
                raise
        return workshop.reference

    def _ghosts(self, wish: Wish) -> tuple[Ghost, ...]:
        moment, make = wish.moment, self._make
        if make is None or wish.before is None or moment.proposed is None:
            return ()
        actions = [each for each in (moment.proposed, moment.labelled) if each is not None]
        try:
            simulation = self._simulation(wish.info, make)
            if not isinstance(simulation, Simulation):
                return ()
            state, executed = wish.before
            if executed is not None:
                state = state_after(simulation, state, executed)
            return tuple(ghosts(simulation, state, actions))
        except Exception:
            # An action that the simulation refuses has no ghost; the rest is still explained.
            return ()

    def _simulation(self, info: EpisodeInfo, make: MakeEnvironment) -> Any:
        workshop, scene = self._workshop, (info.variant, info.run_seed)
        if workshop.environment is None or workshop.scene != scene:
            if workshop.environment is not None:
                workshop.environment.close()
            workshop.environment, workshop.scene, workshop.seed = make(info), scene, None
        if workshop.seed != info.seed:
            workshop.environment.reset(info.seed)
            workshop.seed = info.seed
        return workshop.environment


def wish_of(snapshot: Snapshot, question: Question | None) -> Wish | None:
    """Return what a person who looks at `snapshot` would ask about; None where nothing is to ask.

    That is `question`, where the run stands still before a step; the step that is looked at, where
    the page stands; else the first step of the turn under way, in which the policy does not act.
    """
    if question is not None and snapshot.present:
        moment = Moment(question.observation, question.proposed, None, question.decision)
        last = snapshot.step
        before = None if last is None or not last.state.size else (last.state, last.requested)
        return Wish((question, 0), snapshot.info, moment, before)
    at = _step_in_question(snapshot)
    if at is None:
        return None
    step = snapshot.steps[at]
    before = (step.state, None) if step.state.size else None
    # By the film and not by its info: a scene that is run again is another episode.
    return Wish((id(snapshot.steps), at), snapshot.info, _moment(step), before)


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
    return step.proposed is not None or bool(step.decision.signals)


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
