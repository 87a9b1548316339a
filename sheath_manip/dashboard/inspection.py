"""What a browser may send to viser: a written-out list, checked before viser sees it.

viser obeys any message that it can decode: it sets whatever property of an element a browser
names, to whatever value. Here only the messages of a page's own elements pass, with values of the
element's type and within its range; the rest is dropped, and the connection goes on.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any, Union

import msgspec
import viser
from websockets.asyncio.server import ServerConnection

LONGEST_TEXT = 500
"""characters that a text element takes"""
FARTHEST_M = 1e3
"""from the world's origin that a gizmo may be dragged to"""

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class _Message(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """One of viser's messages, with the fields that the browser sends."""


class _Camera(_Message, tag="ViewerCameraMessage"):
    wxyz: Quaternion
    position: Vector
    fov: float
    near: float
    far: float
    image_height: float
    image_width: float
    look_at: Vector
    up_direction: Vector


class _Update(_Message, tag="GuiUpdateMessage"):
    uuid: str
    updates: dict[str, Any]


class _Hold(_Message, tag="GuiButtonHoldMessage"):
    uuid: str
    frequency: float


class _Dragged(_Message, tag="TransformControlsUpdateMessage"):
    name: str
    wxyz: Quaternion
    position: Vector
    owner: str = ""


class _DragStart(_Message, tag="TransformControlsDragStartMessage"):
    name: str
    owner: str = ""


class _DragEnd(_Message, tag="TransformControlsDragEndMessage"):
    name: str
    owner: str = ""


_decode = msgspec.msgpack.Decoder(
    Union[_Camera, _Update, _Hold, _Dragged, _DragStart, _DragEnd]  # noqa: UP007 - as msgspec says
).decode


class Inspection:
    """Knows the elements of one server's page."""

    def __init__(self) -> None:
        self._server: viser.ViserServer | None = None

    def bind(self, server: viser.ViserServer) -> None:
        """Take note of the server, which is built after the lock on its door."""
        self._server = server

    def admits(self, raw: object) -> bool:
        """Return whether viser may see what a browser has sent."""
        if not isinstance(raw, bytes):
            return False
        try:
            message = _decode(raw)
        except (msgspec.DecodeError, RecursionError):
            return False
        if isinstance(message, _Camera):
            return _finite(msgspec.structs.astuple(message))
        if isinstance(message, _Update):
            return self._admits_update(message.uuid, message.updates)
        if isinstance(message, _Hold):
            return self._element(message.uuid) is not None and _finite([message.frequency])
        if isinstance(message, _Dragged):
            length = math.hypot(*message.wxyz)
            near = all(abs(each) <= FARTHEST_M for each in message.position)
            return near and _finite(message.wxyz) and 0.9 < length < 1.1
        return True

    def _admits_update(self, uuid: str, updates: Mapping[str, Any]) -> bool:
        element = self._element(uuid)
        if element is None or updates.keys() != {"value"}:
            return False
        return fits(updates["value"], element._impl.value, element._impl.props)

    def _element(self, uuid: str) -> Any:
        """The element of that id, where a person may use it."""
        server = self._server
        element = None if server is None else server.gui._gui_input_handle_from_uuid.get(uuid)
        if element is None or element._impl.removed:
            return None
        props = element._impl.props
        usable = getattr(props, "visible", True) and not getattr(props, "disabled", False)
        return element if usable else None


class InspectedConnection:
    """A websocket of which viser receives only what is admitted."""

    def __init__(self, connection: ServerConnection, inspection: Inspection) -> None:
        self._connection = connection
        self._inspection = inspection

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)

    async def recv(self) -> bytes:
        """The next message that is admitted."""
        while True:
            raw = await self._connection.recv()
            if self._inspection.admits(raw):
                assert isinstance(raw, bytes)
                return raw


def fits(value: Any, present: Any, props: Any) -> bool:
    """Return whether an element with those `props` may get `value` for its `present` one."""
    if isinstance(present, bool):
        return isinstance(value, bool)
    if isinstance(present, str):
        options = getattr(props, "options", None)
        known = options is None or value in options
        return isinstance(value, str) and len(value) <= LONGEST_TEXT and known
    if isinstance(present, int | float):
        return _within([value], props)
    if isinstance(present, tuple):
        numbers = all(isinstance(each, int | float) for each in present)
        right = isinstance(value, list) and len(value) == len(present)
        return numbers and right and _within(value, props)
    return False


def _within(values: Iterable[Any], props: Any) -> bool:
    low, high = getattr(props, "min", None), getattr(props, "max", None)
    for place, value in enumerate(values):
        if isinstance(value, bool) or not isinstance(value, int | float) or not _finite([value]):
            return False
        for bound, sign in ((low, 1), (high, -1)):
            if isinstance(bound, list | tuple):
                bound = bound[place] if place < len(bound) else None
            if bound is not None and sign * (value - bound) < -1e-9:
                return False
    return True


def _finite(values: Iterable[Any]) -> bool:
    return all(
        _finite(value) if isinstance(value, tuple | list) else math.isfinite(value)
        for value in values
    )
