"""The folder of one run: its sets, policies, episodes and results, each made once."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.files.json_files import plain, write_json
from sheath_manip.types import Episode
from tools.lerobot.scenes import Scenes
from tools.lerobot.sets import join_sets, write_set
from tools.lerobot.training import POLICY, train_act


class Workshop:
    """Has LeRobot write sets and train policies, by name, and keeps what came of them."""

    def __init__(
        self, folder: Path, scenes: Scenes, steps: int, seed: int, say: Callable[[str], None]
    ) -> None:
        """Store where everything lies, and for how many steps and from which seed is trained."""
        self.folder = folder
        self.scenes = scenes
        self.steps = steps
        self.seed = seed
        self.say = say

    def kept(self, name: str, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """Return the result of that name, made where there is none yet."""
        path = self.folder / f"{name}.json"
        if not path.exists():
            write_json(path, plain(make()))
        return self.result(name)

    def result(self, name: str) -> dict[str, Any]:
        """Read a result that there is."""
        return json.loads((self.folder / f"{name}.json").read_text())

    def trained(
        self, name: str, learned: Sequence[Episode], before: Sequence[str]
    ) -> tuple[Path, int]:
        """Return the directory of a policy trained on `learned` and the sets of before, and frames.

        The frames are those of `learned`.
        """
        fresh = self.folder / f"{name}-set"
        frames = write_set(fresh, learned, self.scenes.spec, self.scenes.robot)
        sets = [*(self.folder / f"{each}-set" for each in before), fresh]
        data = join_sets([each for each in sets if each.exists()], self.folder / f"{name}-all")
        self.say(f"{name}: {frames} new frames, LeRobot trains")
        out = self.folder / f"{name}-policy"
        return train_act(data, out, steps=self.steps, seed=self.seed), frames

    def policy(self, name: str) -> Path:
        """Return the directory of the policy that was trained under that name."""
        return self.folder / f"{name}-policy" / POLICY

    def store(self, method: str, number: int) -> EpisodeStore:
        """Open the episodes of a round of a method."""
        path = self.folder / f"{method}-{number}-episodes"
        return EpisodeStore(path) if path.exists() else EpisodeStore.create(path)

    def episodes(self, method: str, number: int) -> list[Episode]:
        """Read those there are of a round of a method."""
        store = self.store(method, number)
        return list(store.read_many(sorted(store.names())))

    def learned(self, method: str, last: int) -> list[Episode]:
        """Read the episodes of a method's rounds up to the `last`."""
        numbers = range(1, last + 1)
        return [episode for number in numbers for episode in self.episodes(method, number)]


def name_of(method: str, number: int) -> str:
    """Return the name of a method's policy after a round; before the first all share one."""
    return f"{method}-{number}" if number else "start"
