"""A moving picture of a live session: Chromium opens the page, a mouse drags a hole, then bends a corner.

Usage: python scripts/live_gif.py [FILE]      (default: results/live.gif)
"""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from math import hypot
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from PIL import Image, ImageDraw
from playwright.sync_api import Page, sync_playwright

from restshape.outputs.atomic_files import replacing

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "docs" / "examples" / "bracket.toml"
SIZE = (1000, 720)
WORDS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
)
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""WebGL without a graphics card, so that every machine draws alike."""
STEP = 14.0
"""Pixels that the mouse goes between two pictures."""
SECONDS = 0.06
COLOURS, COLOUR_MAP = 230, "viridis"
REST = 6
"""Pictures of what has come to rest."""
INK, GROUND = (20, 20, 20), (255, 255, 255)

Place = tuple[float, float]
HOLE, CORNER = (227.0, 379.0), (583.5, 335.5)
"""Where the page of this size draws them at first."""


@contextmanager
def session() -> Iterator[str]:
    """The address of a page on the scene."""
    command = [sys.executable, "-m", "restshape.cli.main", "live", str(SCENE), "--set", "mesh.size=6 mm"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found, "the command prints its address first"
        try:
            yield found.group()
        finally:
            process.send_signal(signal.SIGINT)


class Film:
    """Pictures of a page in which a mouse goes about.

    Args:
        page: of the session.

    Attributes:
        pictures: so far.
    """

    def __init__(self, page: Page) -> None:
        self._page = page
        self._at: Place = (SIZE[0] / 2, SIZE[1] * 0.8)
        self.pictures: list[Image.Image] = []

    def goes(self, to: Place) -> None:
        """The mouse goes straight to a place, a picture every few pixels."""
        start, length = self._at, hypot(to[0] - self._at[0], to[1] - self._at[1])
        count = max(1, round(length / STEP))
        for k in range(1, count + 1):
            part = k / count
            self._at = (start[0] + part * (to[0] - start[0]), start[1] + part * (to[1] - start[1]))
            self._page.mouse.move(*self._at)
            self._page.wait_for_timeout(40)
            self.shows()

    def holds(self) -> None:
        """The button goes down."""
        self._page.mouse.down()
        self.waits()

    def leaves(self) -> None:
        """The button goes up."""
        self._page.mouse.up()
        self.waits()

    def waits(self) -> None:
        """What has come to rest is shown for a while."""
        self._page.wait_for_timeout(300)
        for _ in range(REST):
            self.shows()

    def shows(self) -> None:
        """Takes a picture, with the pointer, which screenshots leave out."""
        picture = Image.open(BytesIO(self._page.screenshot())).convert("RGB")
        x, y = self._at
        pointer = [(x + dx, y + dy) for dx, dy in ((0, 0), (0, 17), (4, 13), (7, 19), (10, 18), (7, 12), (12, 12))]
        ImageDraw.Draw(picture).polygon(pointer, fill=INK, outline=GROUND)
        self.pictures.append(picture)


def filmed(page: Page) -> list[Image.Image]:
    """Pictures of a hole that is dragged along the arm, and of a corner that is raised."""
    film = Film(page)
    film.waits()
    film.goes(HOLE)
    film.holds()
    film.goes((HOLE[0] + 190, HOLE[1] + 5))
    film.goes((HOLE[0] + 110, HOLE[1]))
    film.leaves()
    film.goes(CORNER)
    film.holds()
    film.goes((CORNER[0] - 5, CORNER[1] - 70))
    film.goes((CORNER[0], CORNER[1] + 15))
    film.leaves()
    return film.pictures


def palette(pictures: list[Image.Image]) -> Image.Image:
    """Colours of all pictures: those of some of them, and all of the colour map, whose ends are rare."""
    found = Image.new("RGB", (SIZE[0], 4 * SIZE[1]))
    for k, picture in enumerate((pictures[0], pictures[len(pictures) // 2], pictures[-1])):
        found.paste(picture, (0, k * SIZE[1]))
    shades = (255 * colormaps[COLOUR_MAP](np.linspace(0.0, 1.0, SIZE[0]))[:, :3]).astype(np.uint8)
    found.paste(Image.fromarray(np.repeat(shades[None], SIZE[1], axis=0)), (0, 3 * SIZE[1]))
    return found.quantize(COLOURS)


def main() -> None:
    """Writes the picture."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "results" / "live.gif"
    chromium = shutil.which("chromium") or shutil.which("google-chrome") or "/usr/bin/chromium"
    with session() as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=[*WORDS, *SOFTWARE])
        page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
        page.goto(address)
        page.get_by_text("von Mises stress").first.wait_for()
        page.wait_for_timeout(1000)
        pictures = filmed(page)
        browser.close()
    colours = palette(pictures)
    frames = [picture.quantize(palette=colours, dither=Image.Dither.NONE) for picture in pictures]
    with replacing(path) as target:
        frames[0].save(
            target, format="GIF", save_all=True, append_images=frames[1:], duration=round(1000 * SECONDS), loop=0
        )
    print(f"{path}: {len(frames)} pictures")


if __name__ == "__main__":
    main()
