"""A live session as the server leads it: between the pages and the process that simulates."""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict
from contextlib import suppress
from typing import Any

from restshape.live.link import ENDED_BY_HAND, LinkClosed
from restshape.live.script_news import ScriptNews
from restshape.live.server_link import ServerLink
from restshape.live.server_messages import OWN, BadMessage, checked, refused
from restshape.live.server_pages import REPLACED, Page, Pages
from restshape.live.server_process import SimulatingProcess
from restshape.live.server_state import ShownState
from restshape.live.server_waiting import Waiting
from restshape.live.server_work import WorkInProgress

Table = dict[str, Any]

PATIENCE = 0.5
"""Seconds after which pages are said that something takes long, and between two such words."""
HASTE = 0.1
"""Seconds from the beginning of an event within which it is not cancelled: its frame may be on its way."""
HEARTBEAT = 5.0
"""Seconds between two empty texts, by which a page knows that its socket is alive."""
MOST_ASKED = 10_000
"""Messages whose pages are known, to which answers go."""
LAST_WORDS = 30.0
"""Seconds that the simulating process has to finish its recording."""
FREE = "no page has the hand"
ELSEWHERE = "another page has the hand"
TAKE_IT = "close that page; the next one that asks has the hand"


class LiveSession:
    """One session, from the first process that simulates until it is ended.

    Args:
        process: that simulates; it has been started.

    Attributes:
        state: that pages show; pages: that are open.
        failure: why nothing could be simulated at all; empty: something was.
    """

    def __init__(self, process: SimulatingProcess) -> None:
        self.state, self.pages, self.failure = ShownState(), Pages(), ""
        self._news = ScriptNews(self.pages.say)
        self._process = process
        self._waiting, self._work = Waiting(), WorkInProgress()
        self._asked: OrderedDict[int, Page] = OrderedDict()
        self._restart = asyncio.Event()
        self._why = ""
        self._restarted, self._fruitless = False, 0
        self._ending = False
        self._link: ServerLink | None = None

    async def lead(self) -> int:
        """Passes on what is said, until the session is ended; the exit code of the simulating process."""
        beside = [asyncio.create_task(one) for one in (self._say_busy(), self._beat())]
        try:
            while True:
                await self._simulate()
                code = await asyncio.to_thread(self._process.wait, LAST_WORDS)
                if self._ending or not code or not self._process.can_start or not (self.state.welcome or self._why):
                    return code
                await self._start_again(code)
                if self._ending:
                    return code
        finally:
            for task in beside:
                task.cancel()

    async def _simulate(self) -> None:
        """Hears what one process says, until it has ended."""
        link = self._link = await ServerLink.of_socket(self._process.end)
        if self._ending:
            link.finish()
        sending = asyncio.create_task(self._send_all(link))
        try:
            with suppress(LinkClosed):
                if self._restarted:
                    link.send(self.state.resuming(self._process.lines))
                while True:
                    self._hear(await link.receive())
        finally:
            # Pages may be closed before the news' own time comes.
            self._news.say()
            sending.cancel()
            self._link = None
            link.close()

    async def _send_all(self, link: ServerLink) -> None:
        """Sends what waits, as fast as the process takes it."""
        with suppress(LinkClosed):
            while True:
                message, text = await self._waiting.take()
                self._work.begin(message)
                link.send(text)
                await link.drained()

    async def _start_again(self, code: int) -> None:
        """Has another process go on with the script, at once or when a page asks for it."""
        why = self._why or f"the simulation has ended by itself ({ended_by(code)})"
        self._fruitless += 1
        at_once = self._fruitless <= 2
        self.pages.say({"type": "lost", "message": why, "restarting": at_once})
        left = self._work.start() + [message["id"] for message in self._waiting.clear()]
        for number in left:
            self._answer(number, refused(number, why))
        self._restart.clear()
        if not at_once:
            await self._restart.wait()
            self._work.start()
        if self._ending:
            return
        self._why, self._restarted = "", True
        self.state.forget()
        self.state.frames.begin_again()
        self._process.start_again()

    def _hear(self, message: str | bytes) -> None:
        """Keeps what the process says, and passes it on."""
        if isinstance(message, bytes):
            header = self.state.frames.add(message)
            self._work.frame(header.get("id", 0))
            self.state.answered(header.get("id", 0))
            self._fruitless = 0
            self.pages.wake()
            return
        said = json.loads(message)
        kind = said["type"]
        if kind == "written":
            self._process.write(said["lines"], said["count"])
            self._work.written(said.get("id", 0))
            self._news.add(said)
            return
        if kind == "resting":
            self._process.resting = said["line"]
            return
        self.state.hear(said)
        if kind == "lost" and not self.state.welcome:
            self.failure = said["message"]
        if kind == "welcome":
            self._greet_all()
        elif "id" in said:
            self._work.answer(said["id"])
            self._answer(said["id"], message)
        else:
            self.pages.say(message)

    def _greet_all(self) -> None:
        # A greeting has the whole script.
        self._news.forget()
        for page in self.pages:
            self._greet(page)

    def _greet(self, page: Page) -> None:
        for message in self.state.greeting(self.pages.role(page), self._process.lines):
            page.say(message, at_once=True)

    def _answer(self, number: int, message: Table | str) -> None:
        """Says an answer to the page that has asked, if it is still there."""
        if page := self._asked.pop(number, None):
            page.say(message)

    async def join(self, page: Page) -> None:
        """A page has opened."""
        self._news.say()
        before = self.pages.join(page)
        self._greet(page)
        if before:
            await before.close(REPLACED, "the same page has opened another socket")

    def leave(self, page: Page) -> None:
        """A page has gone; what its hand holds stays held until another hand lets go of it."""
        self.pages.leave(page)
        if self.pages.hand is None:
            self.pages.say({"type": "note", "message": FREE})
            if self.state.runs:
                # Nobody looks on who could end it.
                stop = {"type": "run", "id": 0, "on": False}
                self._waiting.add(stop, json.dumps(stop))

    def said(self, page: Page, text: str) -> None:
        """A page has said something."""
        try:
            message = checked(text)
        except BadMessage as error:
            page.say(refused(error.number, error.what))
            return
        kind, number = message["type"], message["id"]
        if shown := message.get("shown", kind == "shown"):
            page.shown(shown)
        if kind == "shown":
            return
        if kind == "hand":
            self._ask(page, number)
        elif self.pages.hand is not page:
            page.say(refused(number, ELSEWHERE if self.pages.hand else FREE, TAKE_IT if self.pages.hand else ""))
        elif kind in OWN:
            self._end_frame(page, message, text)
        else:
            self._pass_on(page, message, text)

    def _ask(self, page: Page, number: int) -> None:
        if self.pages.ask(page):
            page.say({"type": "role", "role": "hand"})
        else:
            page.say(refused(number, ELSEWHERE, TAKE_IT))

    def _pass_on(self, page: Page, message: Table, text: str) -> None:
        number = message["id"]
        if not self._waiting.add(message, text):
            page.say(refused(number, "too much waits already", "wait until it was answered"))
            return
        self.state.asks(message)
        self._asked[number] = page
        while len(self._asked) > MOST_ASKED:
            self._asked.popitem(last=False)

    def _end_frame(self, page: Page, message: Table, text: str) -> None:
        """Ends the process, which is started again where it was before the frame; or starts one that has ended."""
        if self._link is None:
            self._restart.set()
        elif message["type"] == "restart" or self._work.seconds() > HASTE:
            if not self._process.can_start:
                # All ranks agree on it, after the frame in work.
                self._pass_on(page, message, text)
                return
            self._why = ENDED_BY_HAND
            self._fruitless = 0
            self._process.kill()
        page.say({"type": "done", "id": message["id"]})

    async def _say_busy(self) -> None:
        while True:
            await asyncio.sleep(PATIENCE)
            seconds = self._work.seconds()
            if seconds >= PATIENCE:
                said = {"seconds": round(seconds, 1), "what": self._work.what, "shows": self._work.has_shown}
                self.pages.say({"type": "busy", **said})

    async def _beat(self) -> None:
        while True:
            await asyncio.sleep(HEARTBEAT)
            self.pages.say("")

    async def end(self) -> None:
        """Has the process finish what it writes, and closes the pages."""
        self._ending = True
        self.pages.say({"type": "lost", "message": self._last_words(), "restarting": False})
        if self._link:
            self._link.finish()
        else:
            self._restart.set()

    def _last_words(self) -> str:
        """That it has ended, and where its script is."""
        out = self.state.welcome and self.state.welcome.get("out")
        return "the session has ended; " + (f"its script is in {out}" if out else "it had no script file")

    def end_now(self) -> None:
        """Ends the process, whatever it still writes."""
        self._process.kill()


def ended_by(code: int) -> str:
    """How a process has ended, in words."""
    return f"signal {-code}" if code < 0 else f"exit code {code}"
