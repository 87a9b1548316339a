"""What a station may say on the page's own websocket, and what of it is heard."""

from typing import Annotated

import msgspec
from msgspec import Meta

from sheath_manip.cockpit import Gamepad, OperatorInput, Order
from sheath_manip.cockpit.shown import Shown
from sheath_manip.types.operator_input import MOST_KEYS

LONGEST_MESSAGE = 2048
"""bytes; a page's own have a tenth of it"""
_Code = Annotated[str, Meta(max_length=20)]
_Share = Annotated[float, Meta(ge=-1.0, le=1.0)]


class _Pad(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    axes: tuple[_Share, _Share, _Share, _Share]
    buttons: Annotated[list[Annotated[int, Meta(ge=0, le=31)]], Meta(max_length=32)]


class OperatorMessage(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """One message of a station."""

    station: Annotated[str, Meta(max_length=40)] | None = None
    """which page it belongs to, first of all"""
    dark: bool | None = None
    """with it: whether the person at the page likes it dark"""
    narrow: bool | None = None
    """with it: whether the window is a small one"""
    keys: Annotated[list[_Code], Meta(max_length=MOST_KEYS)] | None = None
    """the held ones; with it comes the gamepad, and a heartbeat"""
    pad: _Pad | None = None
    clock: Annotated[float, Meta(ge=-1e15, le=1e15)] | None = None
    """when it was sent, in ms by the station's own clock, whatever that counts from"""
    saw: Annotated[int, Meta(ge=0)] | None = None
    """the newest mark of the picture that the page has shown"""
    order: Order | None = None
    value: float = 1.0
    seen: Annotated[int, Meta(ge=0)] | None = None
    """with an order: the number of the newest emergency stop that the station was shown"""
    robot: Annotated[int, Meta(ge=0)] | None = None
    """with an order: the number of the robot that the station was shown"""
    episode: Annotated[int, Meta(ge=0)] | None = None
    """with an order: the number of the episode that the station was shown"""

    @property
    def shown(self) -> Shown:
        """What the station was shown when it gave its order."""
        return Shown(self.seen, self.robot, self.episode)

    def input(self, codes: set[str]) -> OperatorInput | None:
        """Return what is held, of the keys `codes` that drive.

        The answer is None where the message does not say.
        """
        if self.keys is None:
            return None
        pad = self.pad
        return OperatorInput(
            frozenset(codes.intersection(self.keys)),
            None if pad is None else Gamepad(pad.axes, frozenset(pad.buttons)),
        )


_decode = msgspec.json.Decoder(OperatorMessage).decode


def decoded(raw: str | bytes) -> OperatorMessage | None:
    """The message, None where it is none."""
    if not isinstance(raw, str) or len(raw) > LONGEST_MESSAGE:
        return None
    try:
        return _decode(raw)
    except (msgspec.DecodeError, UnicodeEncodeError, RecursionError):
        return None
