"""What `RayExecutor` asks of Ray, in threads of this process: for tests that take no seconds."""

import pickle
import threading
from concurrent.futures import Future
from queue import SimpleQueue
from types import SimpleNamespace
from typing import Any


class RayError(Exception):
    """An actor is lost."""


class RayTaskError(RayError):
    """An actor answered with an exception."""


class Reference:
    """To a value that was put into the store."""

    def __init__(self, key: int) -> None:
        self.key = key


class Handle:
    """An actor in a thread; what it is sent and gives is pickled, as between machines."""

    def __init__(self, kind: type, arguments: tuple[Any, ...]) -> None:
        self.calls: SimpleQueue[tuple[str, bytes, Future] | None] = SimpleQueue()
        self.dead = threading.Event()
        self.asked: list[Future] = []
        self.instance = kind(*arguments)
        threading.Thread(target=self._serve, daemon=True).start()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)

        def ask(*arguments: Any) -> Future:
            future: Future = Future()
            self.asked.append(future)
            self.calls.put((name, pickle.dumps(arguments), future))
            if self.dead.is_set():
                lose(self)
            return future

        return SimpleNamespace(remote=ask)

    def _serve(self) -> None:
        while (call := self.calls.get()) is not None:
            name, arguments, future = call
            try:
                given = getattr(self.instance, name)(*pickle.loads(arguments))
                result, error = pickle.loads(pickle.dumps(given)), None
            except Exception as raised:
                result, error = None, RayTaskError(f"{type(raised).__name__}: {raised}")
            if future.done():
                continue
            if error is None:
                future.set_result(result)
            else:
                future.set_exception(error)


def lose(handle: Handle) -> None:
    """The actor is no more, whatever it was asked."""
    handle.dead.set()
    for future in handle.asked:
        if not future.done():
            future.set_exception(RayError("the actor died"))
    handle.calls.put(None)


class RayHere:
    """Stands for the module."""

    exceptions = SimpleNamespace(RayError=RayError, RayTaskError=RayTaskError)

    def __init__(self, cores: int = 2) -> None:
        self.cores = cores
        self.connected: list[tuple[Any, ...]] = []
        self.put_in: list[Any] = []
        self.handles: list[Handle] = []

    def is_initialized(self) -> bool:
        return False

    def init(self, address: str, **options: Any) -> None:
        self.connected.append((address, options.get("num_cpus")))

    def shutdown(self) -> None:
        self.connected.append(())

    def cluster_resources(self) -> dict[str, float]:
        return {"CPU": float(self.cores)}

    def put(self, value: Any) -> Reference:
        self.put_in.append(value)
        return Reference(len(self.put_in) - 1)

    def get(self, asked: Any) -> Any:
        return self.put_in[asked.key] if isinstance(asked, Reference) else asked.result()

    def kill(self, handle: Handle) -> None:
        lose(handle)

    def remote(self, **options: Any) -> Any:
        del options

        def made(kind: type) -> Any:
            def hire(*arguments: Any) -> Handle:
                self.handles.append(Handle(kind, arguments))
                return self.handles[-1]

            return SimpleNamespace(remote=hire)

        return made
