"""The robots of a run: each free one gets the next episode, and one that is lost is replaced."""

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from queue import SimpleQueue

from sheath_manip.cockpit.post import Post
from sheath_manip.dataset.naming import episode_name
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.fleet.robot import Robot
from sheath_manip.fleet.seat import Seat
from sheath_manip.playback.film import Film
from sheath_manip.protocols.closing import Closes
from sheath_manip.rollout.crowd import Crowd, Ticket
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.worker import Answer, Errand
from sheath_manip.types import Episode


@dataclass(frozen=True, eq=False)
class Ran:
    """What came of one request, and at which robot."""

    request: EpisodeRequest
    robot: int
    """its number; 0 where none could be had"""
    episode: Episode | None = None
    """also one that was cut short, whose outcome is an error"""
    fault: str = ""
    """why it is lost, in a line; empty where it came to its end"""


class Fleet(Closes):
    """Runs requests at several robots, whose person is at one cockpit."""

    def __init__(
        self,
        post: Post,
        cockpit: FleetCockpit,
        on_end: Callable[[Film, Episode], None] = lambda *_: None,
    ) -> None:
        """Store what robots are told; they start with the first request.

        `on_end` is told of each episode that has ended, on any thread.
        """
        self._post = post
        self._cockpit = cockpit
        self._on_end = on_end
        self._free: SimpleQueue[Seat] = SimpleQueue()
        for seat in cockpit.roster.seats:
            self._free.put(seat)
        self._counting = threading.Lock()
        self._unbegun: set[str] = set()
        self._ran_at: dict[str, int] = {}
        self._crowd = Crowd(len(cockpit.roster.seats), self._hire)

    @property
    def robots(self) -> list[Robot]:
        """The robots that there are now."""
        return [each.robot for each in self._crowd.hired if isinstance(each, _Hired)]

    def run(self, requests: Sequence[EpisodeRequest]) -> Iterator[Ran]:
        """Run all of them; give what came of each as it ends.

        A failure costs its episode alone. Where a robot is lost its episode is begun anew by
        another one, a few times, as a `Crowd` does.
        """
        answers: SimpleQueue[tuple[int, Answer]] = SimpleQueue()
        self._unbegun = {episode_name(each.info) for each in requests}
        self._crowd.submit(
            [Ticket(Errand(each, None), place, answers) for place, each in enumerate(requests)]
        )
        for _ in requests:
            place, answer = answers.get()
            request = requests[place]
            robot = self._ran_at.get(episode_name(request.info), 0)
            fault = "" if answer.fault is None else str(answer.fault)
            yield Ran(request, robot, answer.episode, fault)

    def close(self) -> None:
        """End the robots' processes, whatever they are at."""
        self._crowd.close()

    def _hire(self) -> "_Hired":
        seat = self._free.get()
        hired = _Hired(self, Robot(seat, self._post, self._cockpit, self._on_end))
        # Where one was lost for good there may be nothing left to do for its successor.
        self.rest(seat)
        return hired

    def begin(self, seat: Seat, name: str) -> None:
        """Take note of an episode that begins at that robot."""
        with self._counting:
            self._unbegun.discard(name)
            self._ran_at[name] = seat.number
        self._cockpit.finish(seat, finished=False)

    def rest(self, seat: Seat) -> None:
        """Take note that one is over there; where no other waits the robot has finished."""
        with self._counting:
            finished = not self._unbegun
        self._cockpit.finish(seat, finished)

    def release(self, seat: Seat) -> None:
        """Give that seat to the next robot."""
        self._free.put(seat)


@dataclass(eq=False)
class _Hired:
    """A robot as the crowd sees it."""

    fleet: Fleet
    robot: Robot
    ended: bool = False

    def begin(self) -> None:
        """Do nothing: what is sent to a process waits until it has started."""

    def run(self, errand: Errand) -> Answer:
        """Run the episode at the robot."""
        self.fleet.begin(self.robot.seat, episode_name(errand.request.info))
        answer = self.robot.run(errand)
        self.fleet.rest(self.robot.seat)
        return answer

    def end(self) -> None:
        """End the robot, whose seat is then free."""
        self.robot.end()
        if not self.ended:
            self.ended = True
            self.fleet.release(self.robot.seat)
