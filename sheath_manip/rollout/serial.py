"""Episodes run here, one after the other: for a page to follow, and for a person to drive."""

from collections.abc import Iterable, Iterator, Sequence
from typing import ClassVar

from sheath_manip.dataset.background import BackgroundRecorder
from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.protocols import Listener, Report
from sheath_manip.protocols.closing import Closes
from sheath_manip.rollout.executor import unheard
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.types import Episode


class SerialExecutor(Closes):
    """Runs episodes in this process."""

    overlaps: ClassVar[bool] = False

    def __init__(self) -> None:
        self.workplace = Workplace()
        self._recorder: BackgroundRecorder | None = None
        self._fits: EpisodeStore | None = None

    def map(
        self,
        requests: Iterable[EpisodeRequest],
        store: EpisodeStore | None = None,
        listeners: Sequence[Listener] = (),
        report: Report = unheard,
    ) -> Iterator[Episode]:
        """Run each episode, or read it where the store has it, in the order of the requests."""
        try:
            for request in requests:
                yield self._episode(request, store, listeners, report)
        finally:
            # Also where an episode fails: the one before it is whole.
            if self._recorder is not None:
                self._recorder.flush()

    def close(self) -> None:
        """End the process that writes, and free the simulator."""
        recorder, self._recorder = self._recorder, None
        try:
            if recorder is not None:
                recorder.close()
        finally:
            self.workplace.close()

    def _episode(
        self,
        request: EpisodeRequest,
        store: EpisodeStore | None,
        listeners: Sequence[Listener],
        report: Report,
    ) -> Episode:
        info = request.info
        if store is not None and store is not self._fits:
            environment = self.workplace.environment(request.task, info.variant, info.run_seed)
            store.require_fits(RecordedSpec.of_task(environment.spec), "what is to be recorded")
            self._fits = store
        if store is not None and store.has(info):
            episode = store.read(episode_name(info))
        else:
            recorders = () if store is None else (self._recording(store),)
            episode = self.workplace.run(request, (*recorders, *listeners), report)
        report(f"{info.method} round {info.round}")
        return episode

    def _recording(self, store: EpisodeStore) -> BackgroundRecorder:
        """Begun with the first episode that is run: one that is read needs none."""
        if self._recorder is None or self._recorder.store is not store:
            if self._recorder is not None:
                self._recorder.close()
            self._recorder = BackgroundRecorder(store)
        return self._recorder
