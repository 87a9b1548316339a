"""A simulated operator at the page of several robots: it speaks the page's own websocket alone.

What it sees is what the page shows: the words of the notice, and the scene as it stands, in which
the task's scripted expert says what to hold. It reacts late, as `SimulatedOperator` says.
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from websockets.exceptions import ConnectionClosed

from sheath_manip.playback.film import Film
from sheath_manip.protocols import Environment, Expert, Restorable
from sheath_manip.protocols.closing import Closes
from sheath_manip.rollout.simulated_operator import OperatorConfig, SimulatedOperator
from sheath_manip.types import Action, Observation
from tools.scripted_person import Held
from tools.station import Station

LOOK_S = 0.01
AGAIN_S = 0.05
"""after which it looks what became of an order"""


@dataclass
class Eyes:
    """What the expert would do in the scene that is shown: an environment that is put so.

    A film has the state before each step; the step itself leads to the present.
    """

    environment: Environment
    expert: Expert
    _seen: tuple[Film, int] | None = None
    _observation: Observation | None = None

    def action(self, film: Film) -> Action:
        """(a,) what the expert would do at the end of `film`."""
        moment = len(film.steps)
        if self._seen is None or self._seen[0] is not film or self._seen[1] != moment:
            self._seen = film, moment
            self._observation = self.environment.reset(film.info.seed)
            if moment:
                assert isinstance(self.environment, Restorable)
                step = film.steps[moment - 1]
                self.environment.restore(step.state)
                self._observation = self.environment.step(step.executed).observation
            self.expert.reset()
        assert self._observation is not None
        return self.expert.act(self._observation)


@dataclass
class FleetPerson(Closes):
    """Serves one robot after the other, on a thread of its own, until it is closed.

    With it the environment is closed in which its eyes look.
    """

    station: Station
    film: Callable[[], Film | None]
    """the episode that the page shows"""
    eyes: Eyes
    hands: Callable[[Action], Held]
    config: OperatorConfig = field(default_factory=OperatorConfig)
    seed: int = 0
    turns_s: list[float] = field(default_factory=list, init=False)
    """from when a request was offered, or the turn before it handed back, to its hand-back"""

    def __post_init__(self) -> None:
        self._operator = SimulatedOperator(self.config)
        self._operator.begin(np.random.default_rng(self.seed))
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="person", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Leave the page."""
        self._over.set()
        self._thread.join()

    def _serve(self) -> None:
        try:
            self._serve_until_over()
        except ConnectionClosed:
            # The run is over, and its page is gone, maybe in the midst of a word.
            pass
        finally:
            # OpenGL's context belongs to the thread that has drawn in it.
            self.eyes.environment.close()

    def _serve_until_over(self) -> None:
        mine, offered_s = False, time.monotonic()
        while not self._over.wait(LOOK_S):
            shown, now_s = self.station.shown, time.monotonic()
            if shown.get("unready"):
                self.station.order("hand-back")
                time.sleep(0.1)
                continue
            was_mine, mine = mine, bool(shown.get("mine"))
            if was_mine and not mine:
                self.turns_s.append(now_s - offered_s)
                self._operator.leave()
            trouble = not shown.get("may_go_on") if mine else bool(shown.get("asking"))
            if not (mine or trouble):
                offered_s = now_s
            drives = self._operator.drives(trouble, now_s)
            if drives and not mine:
                # Another robot may be shown by now, which is not taken by an order for this one;
                # then it is looked at again.
                self.station.order("take-over")
                self._over.wait(AGAIN_S)
            elif mine and not drives:
                self.station.hold()
                self.station.order("hand-back")
                self.station.until(lambda said: not said.get("mine"))
                self.turns_s.append(time.monotonic() - offered_s)
                mine, offered_s = False, time.monotonic()
            elif mine:
                self._drive()

    def _drive(self) -> None:
        film = self.film()
        if film is not None:
            held = self.hands(self.eyes.action(film))
            self.station.hold(held.keys, held.axes, held.buttons)
