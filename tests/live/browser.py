"""Pages of a real browser that show live sessions, and what they hear and say."""

import json
import re
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from live_worker import Page, cut, replayed

import restshape

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, WebSocket
    from playwright.sync_api import Page as Tab

SECONDS = 30.0
"""Of patience: other tests load the machine."""
WORDS = [
    *("--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
]
SIZE = {"width": 800, "height": 560}
TURN = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done())))"
"""Ends after the display's next turn."""
LOOK = """step => {
    const canvas = document.getElementById("canvas"), found = {};
    const { left, top, right, bottom } = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new PointerEvent("pointerenter"));
    for (let y = top + step; y < bottom; y += step) {
        for (let x = left + step; x < right; x += step) {
            if (document.elementFromPoint(x, y) !== canvas) continue;
            canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: x, clientY: y, pointerType: "mouse" }));
            if (canvas.title) (found[canvas.title] ??= []).push([x, y]);
        }
    }
    return found;
}"""
"""What lies under the places of a grid: "role name" with its places."""


class Session:
    """The command `restshape live` in a process.

    Args:
        start: starts a command; scene: its path; out: the script, which the command writes.
        words: further ones; settings: as of `--set`.
    """

    def __init__(
        self,
        start: Callable[..., subprocess.Popen],
        scene: Path,
        out: Path,
        words: Sequence[str] = (),
        settings: Sequence[str] = (),
    ) -> None:
        self.scene, self.out, self.settings = scene, out, settings
        self.process = start("live", scene, "--out", out, *words, *(f"--set={one}" for one in settings))
        assert self.process.stdout
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.process.communicate()[1]

    def end(self, code: int = 0) -> None:
        """Ends it by Ctrl-C, with its pages open; `code`: that it ends with."""
        self.process.send_signal(signal.SIGINT)
        said = self.process.communicate(timeout=SECONDS)[1]
        assert self.process.returncode == code, (self.process.returncode, said)

    def simulating(self) -> int:
        """The number of the process that simulates."""
        number = self.process.pid
        children = Path(f"/proc/{number}/task/{number}/children").read_text().split()
        words = {child: Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0") for child in children}
        (found,) = [int(child) for child, said in words.items() if b"restshape.live.worker" in said]
        return found

    def script(self) -> list[dict[str, Any]]:
        """The events that are written."""
        return [json.loads(line) for line in self.out.read_text().splitlines()[1:]]

    def assert_replays(self, rows: dict[int, dict[str, Any]]) -> None:
        """The script that was written gives the rows that a page has seen, in all columns but times.

        JSON has no infinite numbers, so that a page does not see them.
        """
        found = replayed(restshape.load(self.scene, *self.settings), self.out)
        assert len(rows) > 2 and max(rows) < len(found)
        for number, row in rows.items():
            seen, again = cut(row), {name: value for name, value in found[number].items() if value != inf}
            differ = {name for name in seen | again if seen.get(name) != again.get(name)}
            assert not differ, (number, {name: (seen.get(name), again.get(name)) for name in differ})


class BrowserPage(Page):
    """A page of a browser.

    Args:
        context: of the browser; address: of the session.

    Attributes:
        said: what the page has sent; faults: errors of its code.
    """

    def __init__(self, context: "BrowserContext", address: str) -> None:
        super().__init__()
        self.tab: Tab = context.new_page()
        self.said: list[dict[str, Any]] = []
        self.beside, self.log = self.tab.locator("#beside"), self.tab.get_by_role("log")
        self.faults: list[str] = []
        self.tab.on("websocket", self._socket)
        self.tab.on("pageerror", lambda error: self.faults.append(str(error)))
        self.tab.on("console", lambda said: self.faults.append(said.text) if said.type == "error" else None)
        self.tab.goto(address)
        self.until(lambda: self.of("frame"), "the first frame")

    def _socket(self, socket: "WebSocket") -> None:
        socket.on("framereceived", lambda content: content and self.take(content))
        socket.on("framesent", lambda content: self.said.append(json.loads(content)))

    def until(self, condition: Callable[[], object], what: str = "") -> Any:
        """What the condition gives when it holds."""
        last = time.monotonic() + SECONDS
        while not (found := condition()):
            assert time.monotonic() < last, f"in vain: {what}; {str(self.heard[-1])[:400]} {self.faults}"
            self.tab.wait_for_timeout(20)
        return found

    @property
    def frame(self) -> dict[str, Any]:
        """The header of the newest frame."""
        return self.of("frame")[-1]

    def frames(self) -> dict[int, dict[str, Any]]:
        """The columns of each frame by its number, as it was shown last."""
        return {one["number"]: one["columns"] for one in self.of("frame")}

    def events(self) -> list[dict[str, Any]]:
        """What the page has asked for by events."""
        return [one for one in self.said if one["type"] == "event"]

    def refusals(self) -> list[str]:
        """Why events were refused."""
        asked = {one["id"] for one in self.events()}
        return [one["message"] for one in self.of("refused") if one["id"] in asked]

    def settle(self) -> None:
        """Waits until the last event is answered; a place of the hand may wait for the display's next turn."""
        self.tab.evaluate(TURN)

        def answered() -> bool:
            last = max((one["id"] for one in self.events()), default=0)
            return any(one.get("id", 0) >= last for one in self.heard if one["type"] in ("frame", "done", "refused"))

        self.until(answered, "the answer to the last event")

    def under(self, step: int = 12) -> dict[str, list[tuple[float, float]]]:
        """What lies under the places of a grid."""
        found: dict[str, list[tuple[float, float]]] = self.tab.evaluate(LOOK, step)
        return found

    def place(self, roles: Sequence[str], name: str = "") -> tuple[float, float]:
        """A place where the first of these roles can be held that there is: the middle one of its places."""
        found = self.until(lambda: self.under(), "something to hold")
        for role in roles:
            for thing, places in found.items():
                if thing.split(" ", 1)[0] == role and name in thing:
                    return places[len(places) // 2]
        raise AssertionError(f"none of {roles} in {sorted(found)}")

    def drag(self, at: tuple[float, float], by: tuple[float, float], steps: int = 3, release: bool = True) -> None:
        """A drag of the mouse, of which each step is computed."""
        mouse = self.tab.mouse
        mouse.move(*at)
        mouse.down()
        for step in range(1, steps + 1):
            mouse.move(at[0] + by[0] * step / steps, at[1] + by[1] * step / steps)
            self.settle()
        if release:
            self.release()

    def release(self) -> None:
        """Lets go of the mouse's button."""
        self.tab.mouse.up()
        self.until(lambda: self.events()[-1]["event"]["do"] == "release", "the release")
        self.settle()

    def drag_in_vain(self, at: tuple[float, float]) -> None:
        """A drag that no answer comes to."""
        mouse = self.tab.mouse
        mouse.move(*at)
        mouse.down()
        mouse.move(at[0] + 12, at[1])
        mouse.up()

    def press(self, name: str) -> None:
        """Presses a button."""
        self.tab.get_by_role("button", name=name, exact=True).first.click()
        self.settle()


def rest(page: BrowserPage, frames: int) -> None:
    """Has nothing happen for so many frames, by the form of that event."""
    page.tab.get_by_label("event", exact=True).select_option("idle")
    page.tab.locator("form.event").get_by_label(re.compile("^frames")).fill(str(frames))
    page.tab.locator("form.event button[type=submit]").click()


def context_of(browser: "Browser", **settings: Any) -> "BrowserContext":
    """A window of its own, small, for software draws it."""
    found = browser.new_context(**{"viewport": SIZE, "color_scheme": "light", **settings})
    found.set_default_timeout(1000 * SECONDS)
    return found
