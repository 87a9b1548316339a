"""A robot's process: environment, policy, gate and a cockpit of its own, told of by messages.

It is as safe alone as beside the page: where the page's process says nothing, its heartbeats are
missing and who drives is lost; where that process is gone, the robot is stopped.
"""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import ClassVar

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.cockpit.operated_task import operated
from sheath_manip.cockpit.post import Post
from sheath_manip.cockpit.question import Question
from sheath_manip.cockpit.standing import Standing
from sheath_manip.cockpit.start import UntilReady
from sheath_manip.fleet.from_robot import Asked, Begun, Ended, Report, Stepped
from sheath_manip.fleet.outbox import Outbox
from sheath_manip.playback.film import film_begun, pose_of
from sheath_manip.protocols import Environment
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.rollout.request import Driver
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.rollout.worker import Answer, Errand, answer_of, end_with_parent
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.types import Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples

BEAT_S = 0.05
"""between two reports where nothing changes"""


def serve_robot(connection: Connection, post: Post) -> None:
    """Run errands until there are no more; the first message is how the others stand."""
    threading.Thread(target=end_with_parent, daemon=True).start()
    standing: Standing = connection.recv()
    cockpit, outbox = post.cockpit(standing), Outbox(connection)
    errands: SimpleQueue[Errand | None] = SimpleQueue()
    listening = threading.Thread(
        target=_listen, args=(connection, cockpit, errands), name="orders", daemon=True
    )
    listening.start()
    task = operated(post.task, cockpit)
    listeners = (
        _Telling(cockpit, outbox),
        UntilReady(cockpit),
        Pacing(post.speed, lambda: cockpit.speed),
    )
    asked_driver: Driver | None = None
    driver: Driver | None = None
    with single_threaded(), Workplace() as workplace:
        while (errand := errands.get()) is not None:
            asked = errand.request
            if driver is None or asked.driver != asked_driver:
                # Kept from episode to episode: a minute of requests does not end with one.
                asked_driver, driver = asked.driver, post.driver(asked.driver, cockpit)
            request = replace(asked, task=task, driver=driver)
            with _reporting(cockpit, outbox):
                outbox.put(answer_of(partial(_run, workplace, request, listeners)))


def _run(workplace: Workplace, request, listeners) -> Answer:
    workplace.run(request, listeners)
    return Answer()


def _listen(
    connection: Connection, cockpit: Cockpit, errands: "SimpleQueue[Errand | None]"
) -> None:
    """Do what is said at once, whatever the loop is at."""
    try:
        while True:
            said = connection.recv()
            if isinstance(said, Errand):
                errands.put(said)
            else:
                said.act_on(cockpit)
    except (EOFError, OSError):
        pass
    finally:
        # Also where something was said that cannot be read: nobody hears any longer.
        cockpit.order(Order.STOP, station=None)
        errands.put(None)


@contextmanager
def _reporting(cockpit: Cockpit, outbox: Outbox) -> Iterator[None]:
    """Say how the robot stands, until the block ends."""
    news, over = threading.Event(), threading.Event()

    def report() -> None:
        asked: Question | None = None
        while not over.is_set():
            if asked is not cockpit.question:
                asked = cockpit.question
                outbox.put(Asked(asked))
            outbox.put(Report(time.monotonic(), cockpit.state, cockpit.still, cockpit.tool_pose))
            news.wait(BEAT_S)
            news.clear()

    cockpit.on_change = news.set
    thread = threading.Thread(target=report, name="reports", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        news.set()
        thread.join()


class _Telling:
    """A listener that tells of the episode, and holds it while the run is paused."""

    keeps: ClassVar[bool] = True
    """who is told records the episode"""

    def __init__(self, cockpit: Cockpit, outbox: Outbox) -> None:
        self._cockpit = cockpit
        self._outbox = outbox

    def on_fit(self, states: Samples) -> None:
        """Do nothing: no fit is made here."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Tell of the scene; blocks while the run is paused."""
        film = film_begun(environment, info)
        self._outbox.put(Begun(info, film.scene, film.first_pose, film.lacks))
        self._cockpit.between.note_episode(runs=True)
        self._cockpit.wait(environment)

    def on_step(self, environment: Environment, step: Step) -> None:
        """Tell of the step; blocks while the run is paused."""
        self._outbox.put(Stepped(step, pose_of(environment)))
        self._cockpit.wait(environment)

    def on_end(self, episode: Episode) -> None:
        """Tell of the whole episode."""
        self._outbox.put(Ended(episode))
        self._cockpit.between.note_episode(runs=False)
