"""What a browser asks of the server: the files of the page, and the socket."""

from __future__ import annotations

import asyncio
import secrets
from pathlib import Path

from aiohttp import WSMsgType, web

from restshape.live.server_address import Address, same
from restshape.live.server_files import FIRST, TYPES, headers, page_files
from restshape.live.server_messages import MOST_BYTES, refused
from restshape.live.server_pages import Page
from restshape.live.server_session import LiveSession

SOCKET = "socket"
MOST_PAGES = 32
ALIVE = 10.0
"""Seconds between two pings: a page that answers none is gone."""
LONGEST_NAME = 64


class Requests:
    """Answers requests of one session.

    Args:
        session: that pages take part in; address: of the server.
    """

    def __init__(self, session: LiveSession, address: Address) -> None:
        self._session, self._address = session, address
        self._files = page_files()
        self._contents: dict[Path, bytes] = {}
        self._once_asked = False

    async def answer(self, request: web.BaseRequest) -> web.StreamResponse:
        """The response to a request: nothing is there for those who do not know the token."""
        token, slash, name = request.path.removeprefix("/").partition("/")
        if not self._address.has_host(request.host):
            return self._refusal(421, "this server has another name")
        if request.method not in ("GET", "HEAD"):
            return self._refusal(405, "there is nothing to be sent here")
        if not self._once_asked and same(token, self._address.once):
            self._once_asked = True
            return self._to_the_page()
        if not self._address.has_token(token):
            return self._refusal(404, "nothing is here: open the address that restshape live has printed")
        if not slash:
            return self._to_the_page()
        if name == SOCKET:
            return await self._socket(request)
        return self._file(name or FIRST)

    def _to_the_page(self) -> web.Response:
        return web.Response(status=302, headers={"Location": str(self._address)} | headers(self._address.port))

    def _refusal(self, status: int, why: str) -> web.Response:
        return web.Response(status=status, text=f"{why}\n", headers=headers(self._address.port))

    def _file(self, name: str) -> web.Response:
        path = self._files.get(name)
        if path is None:
            return self._refusal(404, "the page has no such file")
        if path not in self._contents:
            self._contents[path] = path.read_bytes()
        kind = TYPES[path.suffix]
        charset = None if kind.startswith(("image", "font")) else "utf-8"
        said = headers(self._address.port)
        return web.Response(body=self._contents[path], content_type=kind, charset=charset, headers=said)

    async def _socket(self, request: web.BaseRequest) -> web.StreamResponse:
        if not self._address.has_origin(request.headers.get("Origin", "")):
            return self._refusal(403, "a socket is for the page of this server")
        if len(self._session.pages) >= MOST_PAGES:
            return self._refusal(503, "too many pages are open: close one")
        socket = web.WebSocketResponse(heartbeat=ALIVE, max_msg_size=MOST_BYTES, compress=False)
        if not socket.can_prepare(request):
            return self._refusal(400, "this is the address of a socket")
        await socket.prepare(request)
        name = request.query.get("page", "")[:LONGEST_NAME] or secrets.token_hex(8)
        page = Page(socket, name, self._session.state.frames)
        await self._session.join(page)
        sending = asyncio.create_task(page.send_all())
        try:
            await self._listen(page, socket)
        finally:
            sending.cancel()
            self._session.leave(page)
        return socket

    async def _listen(self, page: Page, socket: web.WebSocketResponse) -> None:
        """Hears a page until its socket closes."""
        async for said in socket:
            if said.type == WSMsgType.TEXT:
                self._session.said(page, said.data)
            elif said.type == WSMsgType.BINARY:
                page.say(refused(0, "a page sends texts"))
            await page.room()
