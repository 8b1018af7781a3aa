"""The server of `restshape live`: it prints its address, serves the page, and ends at Ctrl-C."""

# It imports neither NumPy nor PETSc: those are the simulating process's.

from __future__ import annotations

import asyncio
import os
import signal
import socket
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from aiohttp import web

from restshape.errors import printable
from restshape.live.server_address import Address, listening
from restshape.live.server_browser import open_browser
from restshape.live.server_process import SimulatingProcess
from restshape.live.server_requests import Requests
from restshape.live.server_session import LiveSession

SLOW_END = 1.0
"""Seconds after which a session that ends says what it waits for."""
LOOK = 1.0
"""Seconds between two looks for the process with which a session ends."""


@dataclass(frozen=True)
class Serving:
    """How a session is served.

    Args:
        port: of the loopback; None: any.
        browser: opens one.
        script: file that the process writes; None: none.
        parent: number of the process with which the session ends; None: it goes on by itself.
        endings: signals that end the session.
    """

    port: int | None = None
    browser: bool = False
    script: Path | None = None
    parent: int | None = None
    endings: Iterable[signal.Signals] = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def serve(process: SimulatingProcess, how: Serving) -> int:
    """Serves a session until it ends: 0 after Ctrl-C, 128 + N after another signal, else what the process ended with.

    Raises:
        UserError: the port cannot be had, or the page was not built.
    """
    found, note = listening(how.port)
    with found:
        if note:
            print(f"note: {note}", file=sys.stderr)
        return asyncio.run(_served(process, how, found))


async def _served(process: SimulatingProcess, how: Serving, found: socket.socket) -> int:
    address = Address.of_port(found.getsockname()[1])
    session = LiveSession(process)
    server = web.Server(Requests(session, address).answer, access_log=None)
    runner = web.ServerRunner(server, handle_signals=False, shutdown_timeout=1.0)
    await runner.setup()
    await web.SockSite(runner, found).start()
    leading = asyncio.create_task(session.lead())
    # Who has read the address may end the session.
    end = Ending(session, how.endings)
    _announce(address, how)
    watching = asyncio.create_task(_watch(how.parent, session)) if how.parent else None
    try:
        code = await leading
    finally:
        if watching:
            watching.cancel()
        end.forget()
        await session.pages.close()
        await runner.cleanup()
    if session.failure:
        print(printable(f"restshape live: {session.failure}"), file=sys.stderr)
    # The process has said what went wrong in its end, such as a script for which the disk has no room.
    well = code <= 0
    if how.script and process.events and well:
        print(f"script: {how.script}, {process.events} events")
    return end.exit_code if end.signals and well else _positive(code)


async def _watch(parent: int, session: LiveSession) -> None:
    """Ends a session when the process that has started this one is gone."""
    while os.getppid() == parent:
        await asyncio.sleep(LOOK)
    await session.end()


class Ending:
    """What signals do: the first has the session end in order, the second at once.

    Args:
        session: that they end; numbers: of the signals.

    Attributes:
        signals: that have come.
    """

    def __init__(self, session: LiveSession, numbers: Iterable[signal.Signals]) -> None:
        # Under nohup a session stays when its terminal goes.
        stays = signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
        self._session = session
        self._numbers = tuple(number for number in numbers if not (stays and number == signal.SIGHUP))
        self.signals: list[signal.Signals] = []
        self._task: asyncio.Task[None] | None = None
        for number in self._numbers:
            asyncio.get_running_loop().add_signal_handler(number, self._come, number)

    @property
    def exit_code(self) -> int:
        """0 after Ctrl-C, which is how a session is meant to end."""
        return 0 if self.signals[0] == signal.SIGINT else 128 + self.signals[0]

    def _come(self, number: signal.Signals) -> None:
        self.signals.append(number)
        if len(self.signals) > 1:
            self._session.end_now()
        else:
            self._task = asyncio.create_task(self._end())

    async def _end(self) -> None:
        await self._session.end()
        await asyncio.sleep(SLOW_END)
        print("ending after this frame; Ctrl-C once more ends it at once", file=sys.stderr)

    def forget(self) -> None:
        """From now on signals do what they did before."""
        if self._task:
            self._task.cancel()
        for number in self._numbers:
            asyncio.get_running_loop().remove_signal_handler(number)


def _announce(address: Address, how: Serving) -> None:
    print(f"{address}")
    kept = f"; the script is in {how.script}" if how.script else ""
    print(f"open this address in a browser of this machine; Ctrl-C ends the session{kept}", flush=True)
    if how.browser:
        open_browser(address.for_a_browser)


def _positive(code: int) -> int:
    """An exit code, of a process that a signal has ended as shells say it."""
    return 128 - code if code < 0 else code
