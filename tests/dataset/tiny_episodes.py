"""The smallest episodes that a store takes, and what then lies in its directory."""

from sheath_manip.dataset.archive import SUFFIX
from sheath_manip.dataset.index import INDEX
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Episode, EpisodeInfo, Purpose
from tools.synthetic import synthetic_episode

INFO = EpisodeInfo("driving", 12345, Purpose.LEARNING, 10.0, "sheath", round=3, index=7)


def tiny(info: EpisodeInfo) -> Episode:
    return synthetic_episode(info, length=2, pixels=2)


def entries(store: EpisodeStore) -> list[str]:
    """What is there, the index left out: episodes by their names."""
    found = {path.name.removesuffix(SUFFIX) for path in store.path.iterdir()}
    return sorted(found - {INDEX})
