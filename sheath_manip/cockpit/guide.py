"""Which keys do what: shown on the page, and all that it sends of the keyboard."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Binding:
    """Keys with one purpose."""

    codes: tuple[str, ...]
    """as `KeyboardEvent.code` names them"""
    says: str
    """such as `forward, back`"""

    @property
    def shown(self) -> str:
        """The keys as they are printed on a keyboard."""
        return " ".join(code.removeprefix("Key").removeprefix("Digit") for code in self.codes)
