"""A mouse on a page of Chromium, by its protocol alone: it takes little of the processor that is measured."""

from __future__ import annotations

import json
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

import aiohttp

from restshape.errors import UserError


@dataclass
class Mouse:
    """A mouse on a page.

    Playwright's own runs a script in the page at each move, which a person's does not; and each message goes through
    a process of Playwright's, on its way there and back.

    Args:
        socket: of Chromium's protocol, to the page. Its answers are left unread: a place does not wait until the
            browser has taken the one before.

    Attributes:
        down: the left button is; said: messages so far.
    """

    socket: aiohttp.ClientWebSocketResponse
    down: bool = False
    said: int = 0

    async def move(self, x: float, y: float) -> None:
        """Moves to a place [pixels]."""
        await self._do("mouseMoved", x, y, "left" if self.down else "none")

    async def press(self, x: float, y: float) -> None:
        """Presses the left button."""
        self.down = True
        await self._do("mousePressed", x, y, "left", clickCount=1)

    async def release(self, x: float, y: float) -> None:
        """Lets go of it."""
        self.down = False
        await self._do("mouseReleased", x, y, "left", clickCount=1)

    async def _do(self, kind: str, x: float, y: float, button: str, **more: int) -> None:
        self.said += 1
        about = {"type": kind, "x": x, "y": y, "button": button, "buttons": int(self.down), **more}
        message = {"id": self.said, "method": "Input.dispatchMouseEvent", "params": about}
        await self.socket.send_str(json.dumps(message))


def free_port() -> int:
    """A port of this machine that nothing listens at."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


@asynccontextmanager
async def mouse_of(port: int, address: str) -> AsyncIterator[Mouse]:
    """A mouse on the page of an address.

    Args:
        port: at which Chromium listens; address: with which that of the page begins.

    Raises:
        UserError: no such page is open.
    """
    async with aiohttp.ClientSession() as client:
        async with client.get(f"http://127.0.0.1:{port}/json/list") as answer:
            pages = await answer.json()
        found = next((one for one in pages if one["type"] == "page" and one["url"].startswith(address)), None)
        if found is None:
            raise UserError(f"Chromium shows no page of {address}", "bench live", "start it again")
        async with client.ws_connect(found["webSocketDebuggerUrl"], max_msg_size=0) as socket:
            yield Mouse(socket)
