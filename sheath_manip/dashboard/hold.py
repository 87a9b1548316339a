"""The switch by which a person holds the run."""

import threading


class Hold:
    """Lets steps pass, or keeps them waiting while a person holds the run."""

    def __init__(self) -> None:
        self._may_run = threading.Event()
        self._may_run.set()

    @property
    def paused(self) -> bool:
        """Whether the run is held."""
        return not self._may_run.is_set()

    def pause(self) -> None:
        """Hold the run at its next step."""
        self._may_run.clear()

    def resume(self) -> None:
        """Let it go on."""
        self._may_run.set()

    def wait(self) -> None:
        """Return at once, or as soon as the run may go on."""
        self._may_run.wait()
