"""The pointer on the picture, where it edits nothing: what may be held lights up, and the picture moves and turns."""

import io

import numpy as np
import pytest
from browser import BrowserPage, context_of
from PIL import Image

from restshape.application import applications

LIT = (214, 0, 127)
"""Colour of what lies under the pointer on a light page."""
CORNER = (0.5, 0.9)
"""A place of the picture beside the shape, as shares of its size."""


def picture(page):
    """The picture as it is seen, RGB."""
    page.tab.wait_for_timeout(300)
    return np.asarray(Image.open(io.BytesIO(page.tab.locator("#canvas").screenshot())).convert("RGB")).astype(int)


def lit(page):
    """How many pixels light up."""
    return int((np.abs(picture(page) - LIT).max(axis=2) < 8).sum())


def beside(page):
    """A place of the page where nothing can be held."""
    box = page.tab.locator("#canvas").bounding_box()
    return box["x"] + CORNER[0] * box["width"], box["y"] + CORNER[1] * box["height"]


def test_what_may_be_held_lights_up_and_a_second_finger_lets_go_and_moves_the_picture(bracket_session, browser):
    live = bracket_session()
    phone = context_of(browser, has_touch=True)
    page = BrowserPage(phone, live.address)
    x, y = page.place(["hole"], "window")
    page.tab.mouse.move(1, 1)
    assert lit(page) == 0
    page.tab.mouse.move(x, y)
    assert lit(page) > 50
    page.tab.mouse.move(1, 1)
    assert lit(page) == 0 and not page.events()

    touch = phone.new_cdp_session(page.tab)

    def fingers(kind, *places):
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    fingers("touchStart", (x, y))
    fingers("touchMove", (x + 8, y))
    page.settle()
    before = picture(page)
    fingers("touchStart", (x + 8, y), (x + 60, y + 60))
    fingers("touchMove", (x - 30, y - 30), (x + 110, y + 110))
    fingers("touchEnd")
    page.until(lambda: page.events()[-1]["event"]["do"] == "release", "the release")
    page.settle()
    assert [one["event"]["do"] for one in page.events()] == ["press", "drag", "release"]
    assert (np.abs(picture(page) - before).max(axis=2) > 20).sum() > 10_000
    live.end()
    assert not page.faults


@pytest.mark.weekly
def test_in_space_a_drag_beside_the_shape_turns_the_picture_and_edits_nothing(session, opened):
    in_space = next(one for one in applications().values() if not one.editing.has_mesh)
    live = session(in_space.folder / "template" / "scene.toml")
    page = opened(live)
    x, y = beside(page)
    before, mouse = picture(page), page.tab.mouse
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + 80, y - 20, steps=4)
    mouse.up()
    turned = picture(page)
    assert (np.abs(turned - before).max(axis=2) > 20).sum() > 5_000 and not page.events()
    page.tab.mouse.wheel(0, -240)
    assert (np.abs(picture(page) - turned).max(axis=2) > 20).sum() > 5_000 and not page.events()
    live.end()
    assert not page.faults and not live.script()
