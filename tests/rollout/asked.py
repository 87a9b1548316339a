"""Episodes that executors are asked for, and a digest of what they left in a store."""

import hashlib
from dataclasses import replace

import numpy as np

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.types import EpisodeInfo, Purpose
from tests.toy import CORRIDOR

STEPS_HZ = 50.0


def requests(count: int, driver: Driver | None = None) -> list[EpisodeRequest]:
    infos = [
        EpisodeInfo("corridor", 100 + index, Purpose.DEMONSTRATION, STEPS_HZ, "expert", index=index)
        for index in range(count)
    ]
    return [EpisodeRequest(CORRIDOR, info, driver or ExpertAlone()) for info in infos]


def digest(store: EpisodeStore) -> str:
    """Of all that the episodes hold but the date of the recording."""
    whole = hashlib.sha256()
    for episode in store.episodes():
        whole.update(repr((replace(episode.info), episode.outcome, len(episode))).encode())
        for step in episode.steps:
            for array in (*step.observation.images.values(), step.observation.features):
                whole.update(np.ascontiguousarray(array).tobytes())
            for array in (step.state, step.executed, step.labelled):
                whole.update(np.ascontiguousarray(array).tobytes())
            whole.update(repr((step.decision, step.reward)).encode())
    return whole.hexdigest()
