"""A page of Chromium by its protocol alone, as a person has it: nobody listens to what it loads and receives."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from typing import Any

import aiohttp

from restshape.errors import UserError


class BarePage:
    """A page that Playwright does not see.

    Playwright has its pages report each message of a web socket with all bytes, which the browser and Playwright's
    process then write and read: 2 ms a frame of theirs, and some of the page's.

    Args:
        messages: an open web socket of Chromium's protocol, to the page.
        debugger: the address of that protocol of the page.
    """

    def __init__(self, messages: aiohttp.ClientWebSocketResponse, debugger: str) -> None:
        self._messages, self.debugger = messages, debugger
        self._asked = 0

    async def ask(self, method: str, parameters: Mapping[str, object] | None = None) -> dict[str, Any]:
        """The answer to a method of the protocol.

        Raises:
            UserError: Chromium refuses it, or has ended.
        """
        self._asked += 1
        await self._messages.send_json({"id": self._asked, "method": method, "params": parameters or {}})
        async for message in self._messages:
            answer = json.loads(message.data)
            if answer.get("id") != self._asked:
                continue
            if "error" in answer:
                raise UserError(
                    f"Chromium refuses {method}: {answer['error'].get('message')}", "bench live", "update it"
                )
            found: dict[str, Any] = answer["result"]
            return found
        raise UserError("Chromium has ended", "bench live", "start it again")

    async def evaluate(self, script: str, argument: object = None) -> Any:
        """The value of a script; of a function, what it gives of an argument."""
        text = f"({script})({json.dumps(argument)})" if argument is not None else script
        asked = {"expression": text, "returnByValue": True, "awaitPromise": True}
        found = await self.ask("Runtime.evaluate", asked)
        if "exceptionDetails" in found:
            raise UserError(
                f"the page fails: {found['exceptionDetails'].get('text')}", "bench live", "look at the page"
            )
        return found["result"].get("value")


@asynccontextmanager
async def bare_page(port: int, size: Mapping[str, int], before: str) -> AsyncIterator[BarePage]:
    """An empty page.

    Args:
        port: at which Chromium listens.
        size: "width" and "height" of it [pixels]; before: a script that runs before those of what it loads.

    Raises:
        UserError: Chromium opens none.
    """
    async with aiohttp.ClientSession() as client:
        async with client.put(f"http://127.0.0.1:{port}/json/new?about:blank") as answer:
            if answer.status != 200:
                raise UserError("Chromium opens no page", "bench live", "update it")
            debugger = (await answer.json())["webSocketDebuggerUrl"]
        async with client.ws_connect(debugger, max_msg_size=0) as messages:
            page = BarePage(messages, debugger)
            await page.ask("Emulation.setDeviceMetricsOverride", {**size, "deviceScaleFactor": 1, "mobile": False})
            await page.ask("Emulation.setFocusEmulationEnabled", {"enabled": True})
            await page.ask("Page.enable")
            await page.ask("Page.addScriptToEvaluateOnNewDocument", {"source": before})
            yield page
