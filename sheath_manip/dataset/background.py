"""A recorder that writes an episode while the next one already runs."""

from concurrent.futures import Future, ThreadPoolExecutor

from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.writer_process import WriterLostError, WriterProcess
from sheath_manip.exceptions import StoreError
from sheath_manip.protocols.closing import Closes
from sheath_manip.types import Episode


class BackgroundRecorder(Closes, Recorder):
    """A `Recorder` that writes in the background; a context, at whose end all is on the disk.

    A process of its own compresses and writes it, and a thread waits for that. One episode is
    written at a time: the next one waits for it. What went wrong is raised when the next episode
    ends, by `flush` or at the end of the context, whichever is first, and nothing is recorded after
    it. Where that process is lost or stops, its episode is written here. It takes .4 s of CPU time
    to start: make one for many episodes.
    """

    def __init__(self, store: EpisodeStore) -> None:
        super().__init__(store)
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="recorder")
        self._writer = WriterProcess(store.path)
        self._written: Future[None] | None = None

    def on_end(self, episode: Episode) -> None:
        """Begin to append the episode; raises StoreError where the one before could not be."""
        self.flush()
        # Not in the thread: it would take turns with the simulation at every row.
        recorded = recorded_of(episode, self.space)
        self._written = self._thread.submit(self._keep, recorded)

    def close(self) -> None:
        """`flush`, and end the process."""
        self._thread.shutdown()
        self._writer.close()
        self.flush()

    def _keep(self, recorded: Recorded) -> None:
        try:
            self._writer.append_arrays(recorded)
        except WriterLostError as lost:
            # Where that one had stored it just before, this finds so.
            self.store.keep(recorded)
            raise StoreError(
                f"{lost}; the episode that it was given is stored all the same: call again to go on"
            ) from lost

    def flush(self) -> None:
        """Wait until the last episode is on the disk; raises StoreError where it could not be."""
        written, self._written = self._written, None
        if written is not None:
            written.result()
