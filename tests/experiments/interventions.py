"""Episodes with interventions of several lengths, for figures to choose from."""

from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose
from tests.episodes import episode_of


def episode(
    index: int, actors: str, outcome: Outcome = Outcome.SUCCESS, method: str = "sheath"
) -> Episode:
    info = EpisodeInfo("toy", index, Purpose.LEARNING, 10.0, method, 1, index)
    return episode_of(actors, info=info, outcome=outcome, side_px=40)
