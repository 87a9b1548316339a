"""A feature that is no number is told before anything is fitted to it."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Episode


def without_number(episode: Episode, step: int) -> Episode:
    """The episode, of whose step the second feature is NaN."""
    steps = list(episode.steps)
    observation = steps[step].observation
    features = np.array([observation.features[0], np.nan], np.float32)
    steps[step] = replace(steps[step], observation=replace(observation, features=features))
    return replace(episode, steps=tuple(steps))


def test_train_names_episode_step_and_feature(
    complaint, sheath, made, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    whole, store = EpisodeStore(made / "store"), EpisodeStore.create("store")
    broken = whole.names()[1]
    for episode in whole.episodes():
        name = store.append(episode)
        if name == broken:
            store.drop(name)
            store.append(without_number(episode, 3))
    train = ("train", "corridor", "--store", "store", "--checkpoint", "c.npz")
    for cache in ((), ("--cache", "cache")):
        assert complaint(*train, *cache) == (
            f"sheath: {broken} of store: feature 1 is nan in step 3; wanted numbers to learn from: "
            "mark the stretch as bad in `sheath replay`, or take the episode out with "
            "`sheath data drop`\n"
        )
    assert not Path("c.npz").exists()
    store.mark(broken, Marks(bad=((2, 5),)))
    small = ("--policy.name", "hog-svm", "--gate.signal", "support", "--gate.embedding", "pixels")
    assert sheath(*train, *small)[0] == 0
