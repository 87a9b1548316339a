"""One executor for several processes of this machine: one has the workers, the others ask it.

So that the rounds of several methods and seeds, each in a process of its own, fill all workers.
"""

import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from multiprocessing import current_process
from multiprocessing.connection import Client, Connection, Listener

from sheath_manip.dataset.naming import episode_name
from sheath_manip.exceptions import SheathError, WorkerError
from sheath_manip.protocols.closing import Closes
from sheath_manip.rollout.elsewhere import ElsewhereExecutor
from sheath_manip.rollout.worker import Answer, Errand

BACKLOG = 128
"""askers that may knock at once"""


class Exchange(Closes):
    """Where this process's children ask `executor` for episodes."""

    def __init__(self, executor: ElsewhereExecutor) -> None:
        """Open it; the executor is closed by the one that made it."""
        self._executor = executor
        # On Linux a socket in a folder that only this user can read.
        self._listener = Listener(backlog=BACKLOG, authkey=current_process().authkey)
        self._open = True
        self._thread = threading.Thread(target=self._accept, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """Where a `SharedExecutor` asks."""
        return str(self._listener.address)

    def close(self) -> None:
        """Take no more askers."""
        if not self._open:
            return
        self._open = False
        with suppress(OSError, EOFError):
            # Which wakes the thread that waits for one.
            Client(self.address, authkey=current_process().authkey).close()
        self._thread.join()
        self._listener.close()

    def _accept(self) -> None:
        while self._open:
            # One that is gone before it was let in, or that is none of this process's children.
            with suppress(OSError, EOFError, SheathError, PermissionError):
                asker = self._listener.accept()
                threading.Thread(target=self._serve, args=(asker,), daemon=True).start()

    def _serve(self, asker: Connection) -> None:
        # An asker that ends wants no answers; one whose answers end is told so by that.
        with asker, suppress(OSError, EOFError, SheathError):
            for each in self._executor.ask(asker.recv()):
                asker.send(each)


class SharedExecutor(ElsewhereExecutor):
    """Asks the executor of another process of this machine."""

    def __init__(self, address: str) -> None:
        """Store where the `Exchange` is."""
        self._address = address

    def ask(self, errands: Sequence[Errand]) -> Iterator[tuple[int, Answer]]:
        """Begin all of them now; give the place of each and its answer, as they come."""
        if not errands:
            return iter(())
        try:
            connection = Client(self._address, authkey=current_process().authkey)
            connection.send(list(errands))
        except (OSError, EOFError) as error:
            raise WorkerError(f"the process that has the workers is gone ({error})") from error
        except Exception as error:
            raise WorkerError(
                f"{episode_name(errands[0].request.info)} cannot be sent to a worker process "
                f"({type(error).__name__}: {error}); wanted a driver and a task that can be pickled"
            ) from error
        return _answers(connection, len(errands))

    def close(self) -> None:
        """Do nothing: the workers are another's."""


def _answers(connection: Connection, count: int) -> Iterator[tuple[int, Answer]]:
    with connection:
        for _ in range(count):
            try:
                yield connection.recv()
            except (OSError, EOFError) as error:
                raise WorkerError("the process that has the workers has ended") from error
