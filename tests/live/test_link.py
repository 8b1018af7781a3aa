"""Messages over the socket pair of a live session."""

import asyncio
import json
import math
import socket

import pytest

from restshape.live.link import HEAD, Link, LinkClosed
from restshape.live.server_link import ServerLink


async def exchanged(link: Link, end: socket.socket) -> list[object]:
    """What the server's side takes and sends."""
    server = await ServerLink.of_socket(end)
    server.send({"type": "pause", "id": 1})
    server.send('{"type": "save", "id": 2}')
    found: list[object] = [await server.receive() for _ in range(2)]
    await asyncio.sleep(0)
    found += link.waiting()
    server.close()
    return found


def test_both_sides_take_what_the_other_sends_in_order_and_find_its_end():
    ours, theirs = socket.socketpair()
    link = Link(ours)
    link.send({"type": "done", "id": 7, "x": math.nan, "name": "é"})
    link.send_binary([b"ab", memoryview(bytes(100_000)), b"c"])
    text, frame, *sent = asyncio.run(exchanged(link, theirs))
    assert json.loads(str(text)) == {"type": "done", "id": 7, "x": None, "name": "é"}
    assert frame == b"ab" + bytes(100_000) + b"c"
    assert [json.loads(one)["type"] for one in sent] == ["pause", "save"]
    with pytest.raises(LinkClosed):
        link.receive()


def test_a_message_that_comes_byte_by_byte_is_whole_and_waiting_never_waits():
    ours, theirs = socket.socketpair()
    link = Link(ours)
    content = b'{"type":"pause"}'
    for byte in HEAD.pack(len(content), 0) + content:
        assert link.waiting() == []
        assert link.receive(0.0) is None
        theirs.send(bytes([byte]))
    assert link.receive() == content.decode()
    theirs.send(HEAD.pack(3, 9))
    with pytest.raises(LinkClosed):
        link.receive()


def test_messages_that_came_before_the_end_are_taken_first():
    ours, theirs = socket.socketpair()
    theirs.send(HEAD.pack(2, 0) + b"{}")
    theirs.close()
    link = Link(ours)
    assert link.waiting() == ["{}"]
    with pytest.raises(LinkClosed):
        link.waiting()
    with pytest.raises(LinkClosed):
        link.send({"type": "done", "id": 1})
