"""A listener that puts each finished episode into a store."""

from typing import ClassVar

from sheath_manip.dataset.space import Space
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.protocols import Environment
from sheath_manip.types import Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples


class Recorder:
    """Appends every episode of the rollouts it listens to.

    An episode that is discarded, or whose run is interrupted, leaves nothing.
    """

    keeps: ClassVar[bool] = True

    def __init__(self, store: EpisodeStore) -> None:
        self.store = store
        self.space: Space | None = None
        """of the environment that is listened to"""

    def on_fit(self, states: Samples) -> None:
        """Checkpoints are not kept in the store."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:  # noqa: ARG002
        """Note what features and actions mean; an episode is written when it is complete."""
        self.space = Space.of(environment.spec)

    def on_step(self, environment: Environment, step: Step) -> None:
        """Do nothing: no step is written before an episode is complete."""

    def on_end(self, episode: Episode) -> None:
        """Keep the episode; raises StoreError as `EpisodeStore.keep` does."""
        self.store.keep(recorded_of(episode, self.space))
