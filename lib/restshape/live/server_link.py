"""The server's side of the socket pair to the simulating process."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Mapping
from typing import Self

from restshape.live.link import CHUNK, HEAD, TEXT, LinkClosed, Message, encoded


class ServerLink:
    """The side of an event loop: the server's.

    Args:
        reader, writer: of the socket.
    """

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer

    @classmethod
    async def of_socket(cls, end: socket.socket) -> Self:
        """The link of an end of a socket pair, which it closes."""
        return cls(*await asyncio.open_connection(sock=end, limit=CHUNK))

    async def receive(self) -> Message:
        """The next message.

        Raises:
            LinkClosed: the other side has ended.
        """
        try:
            length, kind = HEAD.unpack(await self._reader.readexactly(HEAD.size))
            content = await self._reader.readexactly(length)
        except (asyncio.IncompleteReadError, OSError) as error:
            raise LinkClosed("the other side has ended") from error
        return content.decode() if kind == TEXT else content

    def send(self, message: Mapping[str, object] | str) -> None:
        """Sends a message of text: an object, or one that is JSON already; it never waits.

        Raises:
            LinkClosed: the link is closed.
        """
        if self._writer.is_closing():
            raise LinkClosed("the other side has ended")
        content = (message if isinstance(message, str) else encoded(message)).encode()
        self._writer.write(HEAD.pack(len(content), TEXT) + content)

    async def drained(self) -> None:
        """Waits until the other side has taken most of what was sent.

        Raises:
            LinkClosed: it has ended.
        """
        try:
            await self._writer.drain()
        except OSError as error:
            raise LinkClosed("the other side has ended") from error

    def finish(self) -> None:
        """Says no more: the other side finds the link closed, and can be heard until it ends."""
        if self._writer.can_write_eof():
            self._writer.write_eof()

    @property
    def unsent(self) -> int:
        """Bytes that the other side has not taken yet."""
        return self._writer.transport.get_write_buffer_size()

    def close(self) -> None:
        """Ends it: the other side finds it closed."""
        self._writer.close()
