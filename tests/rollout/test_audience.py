"""Who follows a run and fails is left out, and is told so where it must know."""

from sheath_manip.rollout.audience import Audience
from sheath_manip.types import EpisodeInfo, Purpose
from tests.toy import Corridor

INFO = EpisodeInfo("corridor", 3, Purpose.EVALUATION, 50.0)


class Failing:
    """Fails in its first step, and notes what it is told."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def on_fit(self, states) -> None:
        del states

    def on_start(self, environment, info) -> None:
        del environment, info
        self.told.append("start")

    def on_step(self, environment, step) -> None:
        del environment, step
        self.told.append("step")
        raise ValueError("no picture")

    def on_end(self, episode) -> None:
        del episode
        self.told.append("end")


class Showing(Failing):
    """Shows something that stands still once it has failed."""

    def on_dropped(self) -> None:
        self.told.append("dropped")
        raise ValueError("nor can it say so")


def test_who_fails_is_told_no_more_but_that(dropped_listeners):
    plain, showing, corridor = Failing(), Showing(), Corridor()
    audience = Audience((plain, showing))
    audience.start(corridor, INFO)
    for _ in range(2):
        audience.step(corridor, None)  # pyright: ignore[reportArgumentType]
    assert plain.told == ["start", "step"]
    assert showing.told == ["start", "step", "dropped"]
    assert len(dropped_listeners) == 2
    dropped_listeners.clear()
