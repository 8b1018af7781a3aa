"""A mouse on a page of Chromium, by its protocol alone: it takes little of the processor that is measured."""

from __future__ import annotations

import base64
import json
import os
import socket
import struct
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from urllib.parse import urlsplit

from restshape.errors import UserError

TEXT = 0x81
"""Begins a whole message of text, as of RFC 6455."""
MASKED = 0x80
NO_MASK = bytes(4)
"""What a client must mask its messages by; it may be anything."""
LONGEST = 125
"""Bytes of a message whose length takes one."""

Place = tuple[float, float]


class Mouse:
    """A mouse on a page.

    Playwright's own runs a script in the page at each move, which a person's does not; and each message goes through
    a process of Playwright's, on its way there and back. A person's mouse costs a program nothing: so what it says is
    made before it moves, and Chromium's answers are left unread.

    Args:
        page: an open socket of Chromium's protocol, to the page.

    Attributes:
        down: the left button is; said: messages so far.
    """

    def __init__(self, page: socket.socket) -> None:
        self._page = page
        self.down, self.said = False, 0

    def move(self, at: Place) -> None:
        """Moves to a place [pixels]."""
        self._page.sendall(self._moved(at))

    def move_along(self, way: Sequence[Place], rate: float) -> None:
        """Moves from place to place [pixels], so many a second."""
        said = [self._moved(at) for at in way]
        begun = time.perf_counter()
        for number, one in enumerate(said):
            time.sleep(max(begun + number / rate - time.perf_counter(), 0.0))
            self._page.sendall(one)

    def press(self, at: Place) -> None:
        """Presses the left button."""
        self.down = True
        self._page.sendall(self._message("mousePressed", at, "left", clickCount=1))

    def release(self, at: Place) -> None:
        """Lets go of it."""
        self.down = False
        self._page.sendall(self._message("mouseReleased", at, "left", clickCount=1))

    def _moved(self, at: Place) -> bytes:
        return self._message("mouseMoved", at, "left" if self.down else "none")

    def _message(self, kind: str, at: Place, button: str, **more: int) -> bytes:
        self.said += 1
        about = {"type": kind, "x": at[0], "y": at[1], "button": button, "buttons": int(self.down), **more}
        return framed(json.dumps({"id": self.said, "method": "Input.dispatchMouseEvent", "params": about}).encode())


def framed(text: bytes) -> bytes:
    """A text as a client sends it through a web socket, whole."""
    length = bytes([MASKED | len(text)]) if len(text) <= LONGEST else struct.pack(">BH", MASKED | 126, len(text))
    return bytes([TEXT]) + length + NO_MASK + text


def free_port() -> int:
    """A port of this machine that nothing listens at."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


@contextmanager
def mouse_of(debugger: str) -> Iterator[Mouse]:
    """A mouse on a page.

    Args:
        debugger: the address of Chromium's protocol of the page.

    Raises:
        UserError: no such page is open.
    """
    with _opened(debugger) as page:
        yield Mouse(page)


def _opened(debugger: str) -> socket.socket:
    """A web socket of Chromium; errors as of `mouse_of`."""
    address = urlsplit(debugger)
    port, path = address.port or 80, address.path
    page = socket.create_connection(("127.0.0.1", port), timeout=10.0)
    page.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    asked = {
        "Host": f"127.0.0.1:{port}",
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(),
        "Sec-WebSocket-Version": "13",
    }
    heads = "".join(f"{name}: {value}\r\n" for name, value in asked.items())
    page.sendall(f"GET {path} HTTP/1.1\r\n{heads}\r\n".encode())
    answer = b""
    while b"\r\n\r\n" not in answer:
        if not (more := page.recv(4096)):
            break
        answer += more
    if not answer.startswith(b"HTTP/1.1 101"):
        page.close()
        raise UserError("Chromium opens no web socket to its page", "bench live", "start it again")
    return page
