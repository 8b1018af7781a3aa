"""What the server and the simulating process send each other: messages over a socket pair, each with its length.

A message is a u4 of its length in bytes, a u1 of its kind, and as many bytes; little-endian. Texts are JSON objects
with a key "type", binary ones are frames, both as of `page/src/protocol.ts`. This module imports nothing of restshape,
so that the server can use it without loading the simulation, and no event loop, which the simulation has no use for.
"""

from __future__ import annotations

import json
import os
import select
import socket
import struct
import time
from collections.abc import Mapping, Sequence
from typing import Self

HEAD = struct.Struct("<IB")
TEXT, BINARY = 0, 1
LARGEST = 1 << 30
"""Bytes of the largest message that is taken."""
CHUNK = 1 << 18
ENDED_BY_HAND = "it was ended by hand, and goes on before its last frame"
"""Why a frame was left out that a page has cancelled."""
MOST_PIECES = os.sysconf("SC_IOV_MAX")
"""Of one call of the system."""

Message = str | bytes
"""A text, or the bytes of a frame."""
Buffer = bytes | bytearray | memoryview
"""A view is one of bytes."""


class LinkClosed(EOFError):
    """The other side has ended."""


class Taken:
    """Messages that come in pieces.

    Attributes:
        whole: those that have come whole, and were not taken yet.
    """

    def __init__(self) -> None:
        self._bytes = bytearray()
        self.whole: list[Message] = []

    def add(self, piece: Buffer) -> None:
        """Takes bytes as they come.

        Raises:
            LinkClosed: the other side says what no message is.
        """
        if not self._bytes and len(piece) >= HEAD.size:
            length, kind = HEAD.unpack_from(piece)
            if kind == TEXT and len(piece) == HEAD.size + length:
                # One whole message, as most are.
                self.whole.append(str(piece[HEAD.size :], "utf-8"))
                return
        self._bytes += piece
        at = 0
        while len(self._bytes) - at >= HEAD.size:
            length, kind = HEAD.unpack_from(self._bytes, at)
            if length > LARGEST or kind not in (TEXT, BINARY):
                raise LinkClosed("what came is no message")
            end = at + HEAD.size + length
            if len(self._bytes) < end:
                break
            content = bytes(memoryview(self._bytes)[at + HEAD.size : end])
            self.whole.append(content.decode() if kind == TEXT else content)
            at = end
        del self._bytes[:at]


def encoded(message: Mapping[str, object]) -> str:
    """The text of a message; numbers that are none become null, for JSON has no NaN."""
    try:
        return json.dumps(message, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    except ValueError:
        return json.dumps(without_nan(message), ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def without_nan(value: object) -> object:
    """A copy of a value of JSON in which numbers that are not finite are None."""
    if isinstance(value, float):
        return value if value - value == 0 else None
    if isinstance(value, Mapping):
        return {key: without_nan(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(one) for one in value]
    return value


class Link:
    """The side of a process that waits: the simulating one's.

    Args:
        end: of the socket pair; the link closes it.
    """

    def __init__(self, end: socket.socket) -> None:
        self._end, self._taken = end, Taken()
        self._before: list[bytes] = []
        self._room = memoryview(bytearray(CHUNK))
        end.setblocking(False)

    @classmethod
    def of_descriptor(cls, number: int) -> Self:
        """The link of an open descriptor, such as one that a process was started with."""
        return cls(socket.socket(fileno=number))

    def waiting(self) -> list[Message]:
        """All messages that have come, in order, without waiting for any.

        Raises:
            LinkClosed: the other side has ended, and all that it sent was taken.
        """
        taken = self._taken
        try:
            while self._read() == CHUNK:
                pass
        except LinkClosed:
            if not taken.whole:
                raise
        if not taken.whole:
            return []
        found, taken.whole = taken.whole, []
        return found

    def receive(self, seconds: float | None = None) -> Message | None:
        """The next message; None if none has come in time.

        Args:
            seconds: that it waits at most; None: for ever.

        Raises:
            LinkClosed: the other side has ended.
        """
        end = None if seconds is None else time.monotonic() + seconds
        while not self._taken.whole:
            left = None if end is None else max(end - time.monotonic(), 0)
            if not select.select([self._end], [], [], left)[0]:
                return None
            self._read()
        return self._taken.whole.pop(0)

    def _read(self) -> int:
        """Takes what is there; how many bytes, fewer than it may take at a time where nothing is left."""
        try:
            size = self._end.recv_into(self._room)
        except (BlockingIOError, InterruptedError):
            return 0
        except OSError as error:
            raise LinkClosed(str(error)) from error
        if not size:
            raise LinkClosed("the other side has ended")
        self._taken.add(self._room[:size])
        return size

    def send(self, message: Mapping[str, object] | bytes) -> None:
        """Sends a message of text, waiting until the system has taken it.

        Args:
            message: an object, or its JSON in UTF-8.

        Raises:
            LinkClosed: the other side has ended.
        """
        content = message if isinstance(message, bytes) else encoded(message).encode()
        self._send(TEXT, [content])

    def send_with_next(self, message: bytes) -> None:
        """Sends the JSON of a message right before the next one, in one call of the system."""
        self._before += [HEAD.pack(len(message), TEXT), message]

    def send_binary(self, pieces: Sequence[Buffer]) -> None:
        """Sends a binary message of these pieces, one after the other; errors as of `send`."""
        self._send(BINARY, pieces)

    def _send(self, kind: int, pieces: Sequence[Buffer]) -> None:
        """Sends pieces; mostly the system takes all at once, as they are."""
        length = sum(map(len, pieces))
        whole = [*self._before, HEAD.pack(length, kind), *pieces]
        length += HEAD.size
        if self._before:
            length += sum(map(len, self._before))
            self._before = []
        count = self._sent(whole if len(whole) <= MOST_PIECES else whole[:MOST_PIECES])
        if count == length:
            return
        left = [memoryview(one) for one in whole if one]
        while left:
            while left and count >= len(left[0]):
                count -= len(left.pop(0))
            if left:
                left[0] = left[0][count:]
                count = self._sent(left[:MOST_PIECES])

    def _sent(self, pieces: Sequence[Buffer]) -> int:
        """How many bytes of pieces the system has taken, once it takes any.

        Raises:
            LinkClosed: the other side has ended.
        """
        while True:
            try:
                return self._end.sendmsg(pieces)
            except (BlockingIOError, InterruptedError):
                select.select([], [self._end], [])
            except OSError as error:
                raise LinkClosed(str(error)) from error

    def close(self) -> None:
        """Ends it: the other side finds it closed."""
        self._end.close()
