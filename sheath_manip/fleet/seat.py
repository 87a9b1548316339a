"""What the page's process knows of one robot, and the way to it."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.question import Question
from sheath_manip.cockpit.state import RobotShown
from sheath_manip.fleet.from_robot import Asked, Begun, Ended, FromRobot, Report, Stepped
from sheath_manip.fleet.outbox import Outbox
from sheath_manip.fleet.to_robot import ToRobot
from sheath_manip.fleet.urgency import Request
from sheath_manip.playback.film import Film
from sheath_manip.types import Actor, EpisodeInfo

SILENT_S = 1.0
"""without a report, after which a robot is not heard of"""
_ORDINALS = {2: "2nd", 3: "3rd"}


class Seat:
    """One robot's place in the fleet; its process may be another one after it was lost."""

    def __init__(self, number: int) -> None:
        self.number = number
        self.film: Film | None = None
        self.question: Question | None = None
        self.report: Report | None = None
        """None while no episode runs, and before one has begun"""
        self.since_s = 0.0
        """since when it starts, or asks"""
        self.finished = False
        self.told_to_begin = False
        self.info: EpisodeInfo | None = None
        """of its present episode, or its last"""
        self._outbox: Outbox | None = None

    def attach(self, outbox: Outbox, now_s: float) -> None:
        """A process is there."""
        self._outbox, self.report, self.question = outbox, None, None
        self.told_to_begin, self.since_s = False, now_s

    def detach(self) -> None:
        """It is gone."""
        self._outbox, self.report, self.question = None, None, None

    def tell(self, message: ToRobot) -> None:
        """Say that to the robot, if there is any; returns at once."""
        if self._outbox is not None:
            self._outbox.put(message)

    def hear(self, message: FromRobot) -> None:
        """Take note of what the robot says."""
        match message:
            case Report():
                before, self.report = self.report, message
                asked = before is not None and before.state.asking and not before.state.taken
                if not asked:
                    self.since_s = message.at_s
            case Asked():
                self.question = message.question
            case Begun():
                self.info = message.info
                self.film = Film(message.info, message.scene, message.first_pose, message.lacks)
            case Stepped():
                assert self.film is not None, "Begun comes before Stepped"
                self.film.append(message.step, message.pose)
            case Ended():
                assert self.film is not None, "Begun comes before Ended"
                self.film.end(message.episode)
                self.report = self.question = None

    def silent_s(self, now_s: float) -> float:
        """Seconds since it was heard of, beyond what is usual."""
        if self.report is None or now_s - self.report.at_s < SILENT_S:
            return 0.0
        return now_s - self.report.at_s

    def request(self, now_s: float) -> Request | None:
        """What it asks of the person; None where it asks nothing, or cannot be served."""
        report = self.report
        if report is None or self.silent_s(now_s) or not report.state.asking:
            return None
        state = report.state
        if state.taken or state.unready or state.stopped:
            return None
        decision = None if self.question is None else self.question.decision
        return Request(
            self.number,
            now_s - self.since_s,
            None if decision is None else decision.reason,
            0.0 if decision is None else decision.threshold - decision.score,
            state.abandoned,
        )

    @property
    def picture(self) -> NDArray[np.uint8] | None:
        """(h, w, 3) what its first camera saw last; None where it has seen nothing."""
        images: Mapping[str, NDArray[np.uint8]] = {}
        if self.question is not None:
            images = self.question.observation.images
        elif self.film is not None and self.film.steps:
            images = self.film.steps[-1].observation.images
        return next(iter(images.values()), None)

    def shown(self, now_s: float, place: int) -> RobotShown:
        """Return how it is, in words; `place` is that in the queue, from 1, and 0 outside of it."""
        does, words = self._words(now_s, place)
        return RobotShown(self.number, does, words)

    def _words(self, now_s: float, place: int) -> tuple[str, str]:
        if self.finished:
            return "finished", "finished"
        if self.report is None:
            return "starts", "starting"
        state = self.report.state
        if silent_s := self.silent_s(now_s):
            return "silent", f"not heard of for {silent_s:.0f} s"
        if state.stopped:
            return "held", "stopped"
        if state.taken:
            return "served", "being served"
        if state.unready:
            return "held", "waiting for you to begin"
        if place:
            waited = f"for {now_s - self.since_s:.0f} s"
            acts = ", the fallback acts" if state.turn is Actor.FALLBACK else ""
            asks = "asking" if place == 1 else f"waiting, {_ORDINALS.get(place, f'{place}th')},"
            return "asks", f"{asks} {waited}{acts}"
        if state.paused:
            return "held", "paused"
        if state.turn is Actor.FALLBACK:
            return "drives", "the fallback acts"
        return ("held", "holding") if state.turn is Actor.HOLD else ("drives", "driving")
