"""The pages that are open: what each has still to be sent, and which of them has the hand."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Literal

from restshape.live.link import encoded
from restshape.live.server_frames import KeptFrames

if TYPE_CHECKING:
    from aiohttp import web

AHEAD = 2
"""Frames that a page may have in hand before it has said that it has taken them."""
MOST_TEXTS = 1_000
"""Texts that wait for a page at most: one that takes none for so long is disconnected."""
REPLACED, TOO_SLOW, ENDED = 4001, 4002, 1001
"""Codes with which sockets are closed."""

Role = Literal["hand", "looker"]


class Page:
    """One page.

    Args:
        socket: of it; name: by which it is known again; frames: that it is to see.
    """

    def __init__(self, socket: web.WebSocketResponse, name: str, frames: KeptFrames) -> None:
        self.name, self._socket, self._frames = name, socket, frames
        self._texts: deque[tuple[str, int]] = deque()
        self._some = asyncio.Event()
        self._seen = 0
        self._in_hand: int | None = None
        self.wake()

    def wake(self) -> None:
        """There may be something to send."""
        self._some.set()

    def say(self, message: Mapping[str, object] | str, at_once: bool = False) -> None:
        """Has a text sent: after the frames that came before it, if the page can take them, or at once."""
        text = message if isinstance(message, str) else encoded(message)
        self._texts.append((text, 0 if at_once else self._frames.count))
        self.wake()

    async def room(self) -> None:
        """Lets others have their turn; a page that takes no answers is not heard any further until it does."""
        await asyncio.sleep(0)
        while len(self._texts) > MOST_TEXTS // 2 and not self._socket.closed:
            await asyncio.sleep(0.01)

    def shown(self, count: int) -> None:
        """It has taken so many frames."""
        self._in_hand = max((self._in_hand or 0) - count, 0)
        self.wake()

    async def send_all(self) -> None:
        """Sends what there is to send, until the socket closes."""
        # aiohttp says by this error that the socket is closing.
        try:
            while not self._socket.closed:
                await self._some.wait()
                self._some.clear()
                if len(self._texts) > MOST_TEXTS:
                    await self.close(TOO_SLOW, "this page takes no messages")
                    return
                while self._texts:
                    text, after = self._texts.popleft()
                    if self._seen < after and self._can_take():
                        await self._send_frame()
                    await self._socket.send_str(text)
                if self._seen < self._frames.count and self._can_take():
                    await self._send_frame()
        except ConnectionResetError:
            return

    def _can_take(self) -> bool:
        return self._in_hand is None or self._in_hand < AHEAD

    async def _send_frame(self) -> None:
        frame, self._seen = self._frames.since(self._seen), self._frames.count
        if self._in_hand is not None:
            self._in_hand += 1
        await self._socket.send_bytes(frame)

    async def close(self, code: int, why: str) -> None:
        """Ends its socket."""
        await self._socket.close(code=code, message=why.encode())


class Pages:
    """All pages, of which the first has the hand.

    Attributes:
        hand: the page that has it, if any.
    """

    def __init__(self) -> None:
        self._pages: dict[str, Page] = {}
        self.hand: Page | None = None

    def __len__(self) -> int:
        """How many are open."""
        return len(self._pages)

    def __iter__(self) -> Iterator[Page]:
        """All that are open."""
        return iter(list(self._pages.values()))

    def join(self, page: Page) -> Page | None:
        """Takes a page; the socket before it of the same page, which is to be closed."""
        before = self._pages.get(page.name)
        self._pages[page.name] = page
        if self.hand is None or self.hand is before:
            self.hand = page
        return before

    def leave(self, page: Page) -> None:
        """A page is gone, unless it has come back already."""
        if self._pages.get(page.name) is page:
            del self._pages[page.name]
            if self.hand is page:
                self.hand = None

    def ask(self, page: Page) -> bool:
        """A page asks for the hand; whether it has it now."""
        if self.hand is None:
            self.hand = page
        return self.hand is page

    def role(self, page: Page) -> Role:
        """What a page may do."""
        return "hand" if self.hand is page else "looker"

    def say(self, message: Mapping[str, object] | str) -> None:
        """Has a text sent to all."""
        text = message if isinstance(message, str) else encoded(message)
        for page in self:
            page.say(text)

    def wake(self) -> None:
        """A frame has come."""
        for page in self:
            page.wake()

    async def close(self) -> None:
        """Ends all sockets."""
        await asyncio.gather(*(page.close(ENDED, "the session has ended") for page in self))
