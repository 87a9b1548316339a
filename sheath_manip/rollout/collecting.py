"""The episodes of one training run: read from the store, or run and recorded now."""

from collections.abc import Callable, Sequence
from functools import partial

from sheath_manip.dataset.background import BackgroundRecorder
from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.protocols import (
    Environment,
    Expert,
    Follows,
    Gate,
    Listener,
    Policy,
    Report,
    TakesOver,
)
from sheath_manip.rollout.discarding import until_kept
from sheath_manip.rollout.loop import rollout
from sheath_manip.seeding import scene_seed
from sheath_manip.types import Action, Episode, EpisodeInfo, Observation, Purpose


class AskedOnce:
    """An expert that remembers its last answer: asked again in the same step it does not think."""

    def __init__(self, expert: Expert) -> None:
        self.expert = expert
        self._last: tuple[Observation, Action] | None = None

    def reset(self) -> None:
        """Forget the last episode."""
        self._last = None
        self.expert.reset()

    def follow(self, observation: Observation) -> None:
        """Pass on, where the expert wants to know."""
        if isinstance(self.expert, Follows):
            self.expert.follow(observation)

    def take_over(self, observation: Observation) -> None:
        """Pass on, where the expert wants to know; what it said before is no longer its answer."""
        if isinstance(self.expert, TakesOver):
            self._last = None
            self.expert.take_over(observation)

    def act(self, observation: Observation) -> Action:
        """(a,) what the expert would do; the very same observation object is the same step."""
        if self._last is None or self._last[0] is not observation:
            self._last = (observation, self.expert.act(observation))
        return self._last[1]


class Recording:
    """Runs the episodes of one training run, each once and for all; to be closed."""

    def __init__(
        self,
        environment: Environment,
        expert: Expert,
        run_seed: int,
        store: EpisodeStore,
        listeners: Sequence[Listener],
        report: Report,
        variant: str,
    ) -> None:
        store.require_fits(RecordedSpec.of_task(environment.spec), "what is to be recorded")
        self.environment = environment
        self.expert = expert
        self.run_seed = run_seed
        self.store = store
        self.listeners = listeners
        self.report = report
        self.variant = variant
        self._recorder: BackgroundRecorder | None = None

    def close(self) -> None:
        """End the process that writes."""
        if self._recorder is not None:
            self._recorder.close()

    def _recording(self) -> BackgroundRecorder:
        """Begun with the first episode that is run: one that is read needs none."""
        if self._recorder is None:
            self._recorder = BackgroundRecorder(self.store)
        return self._recorder

    def episodes(
        self,
        purpose: Purpose,
        method: str,
        number: int,
        count: int,
        gate: Callable[[], Gate],
        policy: Policy | None = None,
        checkpoint: str = "",
    ) -> list[Episode]:
        """`count` episodes of round `number`, driven by `policy` under a `gate` made for each.

        All of them are on the disk then. `checkpoint` is the digest of the file that policy and
        gate are from.
        """
        infos = [self._info(purpose, method, number, index, checkpoint) for index in range(count)]
        try:
            return [self._episode(info, gate, policy) for info in infos]
        finally:
            # Also where an episode fails: the one before it is whole.
            if self._recorder is not None:
                self._recorder.flush()

    def _episode(
        self, info: EpisodeInfo, gate: Callable[[], Gate], policy: Policy | None
    ) -> Episode:
        if self.store.has(info):
            episode = self.store.read(episode_name(info))
        else:
            attempt = partial(
                rollout,
                self.environment,
                info,
                gate(),
                policy=policy,
                expert=self.expert,
                listeners=(self._recording(), *self.listeners),
            )
            episode = until_kept(attempt, info, self.report)
        self.report(f"{info.method} round {info.round}")
        return episode

    def _info(
        self, purpose: Purpose, method: str, number: int, index: int, checkpoint: str
    ) -> EpisodeInfo:
        return EpisodeInfo.of(
            self.environment.spec,
            variant=self.variant,
            # Not by method: all methods meet the same scenes in the same round.
            seed=scene_seed(purpose, self.run_seed, number, index),
            purpose=purpose,
            method=method,
            round=number,
            index=index,
            run_seed=self.run_seed,
            checkpoint=checkpoint,
        )
