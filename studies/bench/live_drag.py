"""A live session driven by a real browser: a mouse drags, and how soon and how often its answers are seen is noted."""

# More than 15 modules: processes, browser and page meet here.

from __future__ import annotations

import asyncio
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from restshape_studies.bench.live_mouse import Mouse, free_port, mouse_of
from restshape_studies.bench.live_notes import FIND, NOTES
from restshape_studies.bench.live_page import BarePage, bare_page
from restshape_studies.bench.live_processes import Spent, spent
from restshape_studies.bench.turns import OutOfTime

from restshape.errors import UserError

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-unsafe-swiftshader",
]
"""Chromium draws as it does by itself without a graphics card: WebGL through SwiftShader, the page without it."""
SCREEN = {"width": 1280, "height": 800}
COMMAND = "restshape.cli.main"
WAIT = 60.0
EMPTY = 150
"""Places of the mouse in a drag of an empty page."""


@dataclass(frozen=True)
class Drag:
    """What the mouse does.

    Args:
        on: beginning of the role and name of what it takes hold of.
        wide, high: how far it goes from there [pixels].
        places: of the mouse; rate: how many a second.
        rests: until it lets go, and how long the picture still moves is waited for [s].
    """

    on: str
    wide: float = 80.0
    high: float = 20.0
    places: int = 300
    rate: float = 125.0
    rests: float = 0.0


def browser() -> str:
    """The path of Chromium.

    Raises:
        UserError: there is none, or no Playwright that drives it.
    """
    try:
        import playwright  # noqa: F401
    except ImportError:
        raise UserError("Playwright is not installed", "bench live", "pip install playwright, or make setup") from None
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        what = f"none of {', '.join(BROWSERS)} is installed"
        raise UserError(what, "bench live", "install Chromium of the distribution: apt install chromium")
    if not Path("/proc/stat").exists():
        raise UserError("this system has no /proc, where the processor's time is", "bench live", "use Linux")
    return found


def dragged(scene: Path, drag: Drag, overrides: Sequence[str] = ()) -> dict[str, Any]:
    """How soon and how often answers are seen; see docs/commands.md."""
    return asyncio.run(_dragged(scene, drag, overrides))


async def _dragged(scene: Path, drag: Drag, overrides: Sequence[str]) -> dict[str, Any]:
    from playwright.async_api import async_playwright

    async with async_playwright() as driver:
        port = free_port()
        more = [*OPTIONS, f"--remote-debugging-port={port}"]
        chromium = await driver.chromium.launch(executable_path=browser(), args=more)
        try:
            async with bare_page(port, SCREEN, NOTES) as page:
                ceiling = await _ceiling(page, drag)
                started = time.time()
                async with _session(scene, overrides) as (process, address):
                    await page.ask("Page.navigate", {"url": address})
                    first = await _first(page, scene) - started
                    await asyncio.sleep(1.5)
                    with mouse_of(page.debugger) as mouse:
                        found = await _moved(page, mouse, drag, {os.getpid(): "driver", process.pid: "server"})
        finally:
            await chromium.close()
    return {"first_s": first, "ceiling_per_second": ceiling, **found}


async def _ceiling(page: BarePage, drag: Drag) -> float:
    """How many turns of the display a second have a new place of the mouse, on a page on which nothing else happens."""
    await page.ask("Page.navigate", {"url": "about:blank"})
    await asyncio.sleep(0.5)
    with mouse_of(page.debugger) as mouse:
        mouse.press((drag.wide, drag.wide))
        await asyncio.to_thread(mouse.move_along, _way(drag.wide, drag.wide, drag, EMPTY), drag.rate)
        mouse.release((drag.wide, drag.wide))
        await asyncio.sleep(0.1)
    return rate(await page.evaluate("restshapeNoted.met"))


def _way(x: float, y: float, drag: Drag, places: int) -> list[tuple[float, float]]:
    """Where the mouse goes from a place [pixels]."""
    return [(x + drag.wide * math.sin(k / 60), y + drag.high * math.sin(k / 25)) for k in range(places)]


async def _first(page: BarePage, scene: Path) -> float:
    """The time since 1970 [s] when the first answer was on screen."""
    for _ in range(int(WAIT / 0.05)):
        shown = float(await page.evaluate("window.restshapeNoted?.shown ?? 0"))
        if shown:
            return shown / 1e3
        await asyncio.sleep(0.05)
    raise OutOfTime(
        f"no answer was on screen within {WAIT:.0f} s", str(scene), "look at the page: restshape live SCENE"
    )


@asynccontextmanager
async def _session(scene: Path, overrides: Sequence[str]) -> AsyncIterator[tuple[subprocess.Popen[str], str]]:
    """The process of `restshape live`, and the address that it prints."""
    sets = [word for one in overrides for word in ("--set", one)]
    words = [sys.executable, "-P", "-m", COMMAND, "live", str(scene), *sets]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    try:
        address = await asyncio.to_thread(process.stdout.readline)  # type: ignore[union-attr]
        if not address:
            raise UserError(f"restshape live ended: {process.stderr.read().strip()}", str(scene), "start it by hand")  # type: ignore[union-attr]
        yield process, address.strip()
    finally:
        process.send_signal(signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            await asyncio.to_thread(process.wait, 10)
        if process.poll() is None:
            process.kill()


async def _moved(page: BarePage, mouse: Mouse, drag: Drag, roots: dict[int, str]) -> dict[str, Any]:
    """Presses, drags and lets go; what was noted."""
    name, (x, y) = await _place(page, drag.on)
    mouse.move((x - 2, y))
    mouse.move((x, y))
    mouse.press((x, y))
    await asyncio.sleep(0.5)
    await page.evaluate(
        "Object.assign(restshapeNoted, { sent: new Map(), drawn: [], bytes: [], turns: [], met: [] }); 0"
    )
    way = _way(x, y, drag, drag.places)
    before, begun = spent(roots), time.perf_counter()
    await asyncio.to_thread(mouse.move_along, way, drag.rate)
    took = time.perf_counter() - begun
    used = spent(roots).since(before)
    await asyncio.sleep(0.5)
    noted = await page.evaluate("({ ...restshapeNoted, sent: [...restshapeNoted.sent] })")
    released = await page.evaluate("performance.now()")
    mouse.release(way[-1])
    found = summed_up(noted, used, took)
    if drag.rests:
        await asyncio.sleep(drag.rests)
        last = await page.evaluate("restshapeNoted.drawn.at(-1)?.[1] ?? 0")
        found["rest_s"] = max(last - released, 0.0) / 1e3
    return {"held": name, **found}


async def _place(page: BarePage, on: str) -> tuple[str, tuple[float, float]]:
    """The name of what is taken hold of, and the middle of the places where it lights up."""
    step = 12
    found: list[tuple[str, list[tuple[float, float]]]] = await page.evaluate(FIND, [[on], step])
    if not found:
        raise UserError("nothing lights up under the pointer", "bench live", "look at the page: restshape live SCENE")
    name, places = max(found, key=lambda one: len(one[1]))
    middle = [sum(place[axis] for place in places) / len(places) for axis in (0, 1)]
    return name, min(places, key=lambda place: math.dist(place, middle))


def summed_up(noted: dict[str, Any], used: Spent, took: float) -> dict[str, Any]:
    """What is told of a drag that took some seconds."""
    first: dict[int, float] = {}
    for number, at in noted["drawn"]:
        first.setdefault(int(number), at)
    sent = {int(number): times for number, times in noted["sent"]}
    waits = sorted(at - sent[number][0] for number, at in first.items() if number in sent)
    inputs = sorted(at - sent[number][1] for number, at in first.items() if number in sent)
    drawn = len(noted["drawn"])
    return {
        "answers": len(waits),
        "shown_ms": {"p50": share(waits, 0.5), "p95": share(waits, 0.95)},
        "input_ms": {"p50": share(inputs, 0.5), "p95": share(inputs, 0.95)},
        "frames_per_second": rate([at for _, at in noted["drawn"]]),
        "turns_per_second": rate(noted["turns"]),
        "bytes": median(noted["bytes"]) if noted["bytes"] else 0,
        "processor_ms": {kind: 1e3 * seconds / max(drawn, 1) for kind, seconds in used.by.items()},
        "elsewhere": used.elsewhere / took,
    }


def rate(times: Sequence[float]) -> float:
    """How often a second, from the first to the last of rising times [ms]; NaN of fewer than two."""
    return 1e3 * (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else math.nan


def share(rising: Sequence[float], of: float) -> float:
    """The value below which a share of rising values lies; NaN of none."""
    return rising[min(int(of * len(rising)), len(rising) - 1)] if rising else math.nan
