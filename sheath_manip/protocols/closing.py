"""What is to be closed is a context that closes it."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import Self


class Closes(ABC):
    """A class whose objects hold what must be freed: `with` closes them at the end of its block."""

    @abstractmethod
    def close(self) -> None:
        """Free what is held; nothing happens where it is free already."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
