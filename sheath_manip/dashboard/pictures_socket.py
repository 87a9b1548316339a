"""A websocket of the page's own with a small picture of what each of several robots sees.

A picture is sent once the one before was answered for, so that over a slow link they come seldom
and never in a queue: what is driven by has the right of way.
"""

import asyncio
import base64
import json
from collections.abc import Callable, Mapping
from contextlib import suppress

import cv2
import numpy as np
from numpy.typing import NDArray
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed
from websockets.protocol import State

PATH = "/pictures"
"""below the page's own"""
EVERY_S = 0.5
WIDTH_PX = 144
QUALITY = 70
Pictures = Callable[[], Mapping[int, NDArray[np.uint8]]]
"""(h, w, 3) what each robot sees now, by its number"""


class PicturesSocket:
    """Serves every page; where there is one robot alone it has nothing to send."""

    def __init__(self, pictures: Pictures = dict) -> None:
        self._pictures = pictures

    async def serve(self, connection: ServerConnection) -> None:
        """Serve one page until it goes; what it says is only that it has seen."""
        shown: dict[int, NDArray[np.uint8]] = {}
        with suppress(ConnectionClosed):
            while connection.state is State.OPEN:
                seen = self._pictures()
                news = {
                    number: image
                    for number, image in seen.items()
                    if image is not shown.get(number)
                }
                shown |= news
                if news:
                    small = {number: _encoded(image) for number, image in news.items()}
                    await connection.send(json.dumps(small))
                    await connection.recv()
                await asyncio.sleep(EVERY_S)


def _encoded(image: NDArray[np.uint8]) -> str:
    """The picture as an address that a browser shows."""
    width = min(WIDTH_PX, image.shape[1])
    size = width, max(1, round(image.shape[0] * width / image.shape[1]))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(
        ".jpg", cv2.cvtColor(small, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, QUALITY]
    )
    return f"data:image/jpeg;base64,{base64.b64encode(jpeg.tobytes()).decode()}"
