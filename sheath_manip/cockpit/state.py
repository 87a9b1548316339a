"""What the page shows of the cockpit."""

from dataclasses import dataclass

from sheath_manip.cockpit.between import Pastime
from sheath_manip.playback.labels import FALLBACK
from sheath_manip.types import Actor


@dataclass(frozen=True)
class RobotShown:
    """What the page shows of one robot of several."""

    number: int
    """from 1"""
    does: str
    """one of `starts`, `drives`, `asks`, `served`, `held`, `finished`, `silent`: its colour"""
    words: str
    """how it is, for a person"""


@dataclass(frozen=True)
class State:
    """What the page shows of the cockpit, and what its orders go by."""

    operated: bool
    """whether a person may drive this run at all"""
    paused: bool = False
    speed: float = 1.0
    stopped: bool = False
    stops: int = 0
    """emergency stops so far: a reset says this number, and clears none that came later"""
    episode: int = 0
    """its number, which an order to end it says"""
    taken: bool = False
    abandoned: bool = False
    """whether who drove was lost or stopped: the robot holds until somebody says who goes on"""
    unready: bool = False
    """whether the run waits for a person before it begins"""
    between: Pastime | None = None
    """what is done instead of an episode; None while one runs, and before the first"""
    over: bool = False
    """whether no run goes on, so that nothing is left to order"""
    discard_s: int | None = None
    """until the episode is discarded, which somebody may still call off; None: it is not to be"""
    turn: Actor = Actor.POLICY
    asking: bool = False
    """whether the robot waits for a person"""
    may_go_on: bool = True
    """whether the gate would let the policy act: then who drives may hand back"""
    left_s: float = 0.0
    """until somebody else acts in the person's place"""
    operator: str | None = None
    """the station that drives"""
    fallback: str = FALLBACK
    """who acts where nobody comes, in words"""
    robot: int = 0
    """the number of the robot that is shown, where there are several; 0: it is the only one"""
    robots: tuple[RobotShown, ...] = ()
    """all of them, where there are several"""
