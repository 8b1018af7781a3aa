"""A server of live sessions in this process, with a stand-in that simulates, and pages that are none of a browser."""

import asyncio
import json
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import aiohttp
from aiohttp import web

from restshape.live import server_requests
from restshape.live.server_address import Address, listening
from restshape.live.server_frames import parsed
from restshape.live.server_process import SimulatingProcess
from restshape.live.server_session import LiveSession

TIMEOUT = 10.0


class StandIn(SimulatingProcess):
    """Runs `stand_in_worker.py`."""

    def command(self, number: int, more: list[str]) -> list[str]:
        """Its words."""
        file = Path(__file__).with_name("stand_in_worker.py")
        return [sys.executable, str(file), "--link", str(number), *more, *self.words]


class Client:
    """A page.

    Args:
        socket: of it.

    Attributes:
        arrays: of all frames so far, by part and name; frames: headers of these frames.
    """

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.socket, self._number = socket, 0
        self.arrays: dict[tuple[str, str], bytes] = {}
        self.frames: list[dict[str, Any]] = []
        self.texts: list[dict[str, Any]] = []

    async def say(self, **message: Any) -> int:
        """Sends a message; its number."""
        self._number += 1
        await self.socket.send_str(json.dumps(message | {"id": self._number}))
        return self._number

    async def do(self, do: str, latest: bool = False, **keys: Any) -> int:
        """Sends an event."""
        return await self.say(type="event", event={"do": do, **keys}, latest=latest)

    async def hear(self) -> dict[str, Any]:
        """The next message, frames by their headers."""
        while True:
            said = await asyncio.wait_for(self.socket.receive(), TIMEOUT)
            if said.type == aiohttp.WSMsgType.TEXT and said.data:
                self.texts.append(json.loads(said.data))
                return self.texts[-1]
            if said.type == aiohttp.WSMsgType.BINARY:
                return self._take(said.data)
            if said.type != aiohttp.WSMsgType.TEXT:
                raise ConnectionError(f"{said.type.name} {said.data}")

    def _take(self, data: bytes) -> dict[str, Any]:
        header, content = parsed(data)
        self.frames.append(header)
        for part in header["parts"]:
            for name, place in part.get("arrays", {}).items():
                size = 4 * place["shape"][0]
                self.arrays[part["name"], name] = bytes(content[place["at"] : place["at"] + size])
        return header

    async def until(self, kind: str, **keys: Any) -> dict[str, Any]:
        """The next message of a type with these keys."""
        while True:
            message = await self.hear()
            if message["type"] == kind and all(message.get(key) == value for key, value in keys.items()):
                return message


class Served:
    """A server that runs.

    Args:
        address: of it; session: that it serves; http: to ask it by.
    """

    def __init__(self, address: Address, session: LiveSession, http: aiohttp.ClientSession) -> None:
        self.address, self.session, self.http = address, session, http

    async def page(self, name: str = "a", origin: str | None = None) -> Client:
        """A page that opens its socket."""
        own = f"http://127.0.0.1:{self.address.port}"
        url = f"{self.address}socket?page={name}"
        return Client(await self.http.ws_connect(url, origin=own if origin is None else origin, max_msg_size=0))


@asynccontextmanager
async def served(folder: Path, *words: str) -> AsyncIterator[Served]:
    """A server of a session, and its end."""
    found, _ = listening(None)
    address = Address.of_port(found.getsockname()[1])
    process = StandIn(words)
    session = LiveSession(process)
    (folder / "index.html").write_text("<title>page</title>")
    server_requests.page_files, before = lambda: {"index.html": folder / "index.html"}, server_requests.page_files
    try:
        requests = server_requests.Requests(session, address)
    finally:
        server_requests.page_files = before
    runner = web.ServerRunner(web.Server(requests.answer, access_log=None), shutdown_timeout=0.1)
    await runner.setup()
    await web.SockSite(runner, found).start()
    leading = asyncio.create_task(session.lead())
    try:
        async with aiohttp.ClientSession() as http:
            yield Served(address, session, http)
    finally:
        await session.end()
        session.end_now()
        await asyncio.wait_for(leading, TIMEOUT)
        await session.pages.close()
        await runner.cleanup()


def run(folder: Path, story: Callable[[Served], Awaitable[None]], *words: str) -> None:
    """Runs what a test has happen at a server."""

    async def all_of_it() -> None:
        async with served(folder, *words) as server:
            await story(server)

    asyncio.run(all_of_it())
