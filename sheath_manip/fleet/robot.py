"""The page's side of one robot's process: it starts it, hears it, and ends it."""

import logging
import multiprocessing
import threading
from collections.abc import Callable
from dataclasses import replace

from sheath_manip.cockpit.post import Post
from sheath_manip.dataset.naming import episode_name
from sheath_manip.exceptions import WorkerError
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.fleet.from_robot import Ended
from sheath_manip.fleet.outbox import Outbox
from sheath_manip.fleet.robot_process import serve_robot
from sheath_manip.fleet.seat import Seat
from sheath_manip.playback.film import Film
from sheath_manip.rollout.crowd import LostWorkerError
from sheath_manip.rollout.interrupts import deaf_children
from sheath_manip.rollout.worker import Answer, Errand
from sheath_manip.types import Episode, Outcome

logger = logging.getLogger(__name__)

_starting = threading.Lock()
"""multiprocessing starts one process at a time"""


class Robot:
    """A process that runs episodes, in a seat of the fleet."""

    def __init__(
        self,
        seat: Seat,
        post: Post,
        cockpit: FleetCockpit,
        on_end: Callable[[Film, Episode], None],
    ) -> None:
        """Start the process; `on_end` is told of each episode that has ended there."""
        self.seat = seat
        self._cockpit = cockpit
        self._on_end = on_end
        self._ended = False
        # Spawned, not forked: neither torch's threads nor a GL context survive a fork.
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self.process = context.Process(target=serve_robot, args=(theirs, post), daemon=True)
        with _starting, deaf_children():
            self.process.start()
        theirs.close()
        self._outbox = Outbox(self._connection)
        cockpit.attach(seat, self._outbox)

    def run(self, errand: Errand) -> Answer:
        """Run the episode and pass on what it says; raises LostWorkerError where it goes silent.

        The answer has the episode also where that was cut short.
        """
        name = episode_name(errand.request.info)
        try:
            self._outbox.put_checked(errand)
        except Exception as error:
            # What cannot be pickled says so in many ways, before any of it is sent.
            return Answer(
                fault=WorkerError(
                    f"{name} cannot be sent to a robot's process ({type(error).__name__}: "
                    f"{error}); wanted a driver that can be pickled, or one robot"
                )
            )
        episode: Episode | None = None
        try:
            while True:
                said = self._connection.recv()
                if isinstance(said, Answer):
                    return replace(said, episode=episode)
                self._cockpit.hear(self.seat, said)
                if isinstance(said, Ended) and self.seat.film is not None:
                    episode = said.episode
                    self._on_end(self.seat.film, episode)
        except Exception as error:
            # Gone, or it says what nobody understands: its episode is lost alone.
            if episode is not None and episode.outcome is not Outcome.ERROR:
                return Answer(episode)
            if isinstance(error, EOFError | OSError):
                self.process.join()
                why = f"with exit code {self.process.exitcode}"
            else:
                why = f"by what it said ({type(error).__name__}: {error})"
            if not self._ended:
                logger.warning(
                    "robot %d was lost %s: %s is begun anew, the others go on",
                    *(self.seat.number, why, name),
                )
            raise LostWorkerError(why) from error

    def end(self) -> None:
        """End the process, and with it the connection."""
        if not self._ended:
            self._ended = True
            self._cockpit.detach(self.seat)
            self._outbox.close()
        self.process.terminate()
        self.process.join()
