"""What the hand does besides holding, in a browser: tools, handles, recording; frames that hang, and sleep."""

import os
import signal
from contextlib import contextmanager, suppress

import pytest
from browser import rest

from restshape.live.link import ENDED_BY_HAND
from restshape.replay.recording.recording import Recording

ROUND = "hole"


@contextmanager
def stopped(number):
    """A process that stands still; one that is ended meanwhile stays so."""
    os.kill(number, signal.SIGSTOP)
    try:
        yield
    finally:
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGCONT)


def grip(page, kind, by):
    """Drags a handle beside what is selected; the edits that this has sent."""
    before = len(page.events())
    box = page.tab.locator(f".grip[aria-label^={kind}]").bounding_box()
    x, y = box["x"] + 15, box["y"] + 15
    page.tab.mouse.move(x, y)
    page.tab.mouse.down()
    for part in (0.5, 1.0):
        page.tab.mouse.move(x + part * by[0], y + part * by[1])
        page.until(lambda: len(page.events()) > before, f"the handle {kind}")
        page.settle()
    page.tab.mouse.up()
    page.settle()
    return page.events()[before:]


def chosen(page, role, name):
    """Clicks something, which is selected then."""
    page.tab.mouse.click(*page.place([role], name))
    page.until(lambda: name in page.tab.locator("#tools .selection").inner_text(), "what is selected")


def drill(page, x, y):
    """Makes a hole with its middle there."""
    page.tab.get_by_role("button", name="Hole", exact=True).click()
    page.tab.mouse.move(x, y)
    page.tab.mouse.down()
    page.tab.mouse.move(x + 12, y, steps=3)
    page.tab.mouse.up()
    page.until(lambda: page.events() and page.events()[-1]["event"]["do"] == "hole", "a hole")
    page.settle()


def test_a_tool_a_handle_cancel_and_a_short_sleep(bracket_session, opened):
    live = bracket_session()
    page = opened(live)
    (x, y), (right, _) = page.place([ROUND], "window"), page.place(["edge"], "tip")
    drill(page, (x + right) / 2, y)
    page.tab.get_by_role("button", name="Hold", exact=True).click()
    page.drag((x, y), (9.0, 6.0), steps=1, release=False)
    with stopped(live.simulating()):
        page.tab.wait_for_timeout(300)
    page.tab.mouse.move(x + 11, y + 6)
    page.until(lambda: len(live.script()) == 4, "an answer after the sleep")
    page.release()
    assert {one["event"]["do"] for one in grip(page, "rotate", (20.0, 12.0))} == {"rotate"}
    # An event of many quick frames is cancelled.
    number, script = page.frame["number"], live.script()
    rest(page, 50_000)
    page.tab.get_by_role("button", name="Cancel").click()
    page.until(lambda: page.frame["number"] == number, "the state before")
    page.press("Undo")
    live.end()
    assert live.script()[:-1] == script and live.script()[-1]["do"] == "undo"
    assert [event["do"] for event in script[:5]] == ["hole", "press", "drag", "drag", "release"]
    assert page.refusals() == [ENDED_BY_HAND] and not page.faults
    live.assert_replays({key: row for key, row in page.frames().items() if key <= number + 1})


def test_what_is_asked_by_the_way_is_said_to_take_long_until_it_is_answered(bracket_session, opened):
    live = bracket_session()
    page = opened(live)
    busy = page.tab.locator(".busy")
    place, answered = page.place([ROUND], "window"), len(page.of("rates"))
    with stopped(live.simulating()):
        page.tab.mouse.click(*place)
        page.until(lambda: "rates" in busy.inner_text() and busy.is_visible(), "that it takes long")
    page.until(lambda: len(page.of("rates")) > answered, "the answer")
    page.until(busy.is_hidden, "that it is over")
    live.end()
    assert not page.faults


@pytest.mark.weekly
def test_tools_and_handles_by_the_mouse_and_frames_that_hang(bracket_session, opened, tmp_path):
    live = bracket_session("--record", str(recorded := tmp_path / "recorded.vtkhdf"))
    page = opened(live)
    (x, y), (right, _) = page.place([ROUND], "window"), page.place(["edge"], "tip")
    drill(page, (x + right) / 2, y)
    page.tab.get_by_role("button", name="Arc", exact=True).click()
    page.tab.mouse.move(*page.place(["edge"], "tip"))
    page.tab.mouse.down()
    page.tab.mouse.move(right + 10, y)
    page.until(lambda: page.events()[-1]["event"]["do"] == "arc", "an arc")
    page.settle()
    page.tab.mouse.up()
    page.tab.get_by_role("button", name="Hold", exact=True).click()

    page.press("Record")
    page.until(lambda: page.frame.get("records"), "the recording")
    chosen(page, ROUND, "window")
    assert {one["event"]["do"] for one in grip(page, "rotate", (20.0, 12.0))} == {"rotate"}
    scaled = grip(page, "scale", (6.0, 6.0))
    assert {one["event"]["do"] for one in scaled} == {"scale"} and len({one["gesture"] for one in scaled}) == 1
    chosen(page, "edge", "window.1")
    page.press("Smooth")
    assert page.frame["columns"]["event"] == "smooth"
    page.press("Record")
    page.until(lambda: not page.frame.get("records"), "the end of the recording")

    # A frame that hangs is cancelled: the state before it comes back. One that a sleeping machine stops goes on.
    number, shown, lines = page.frame["number"], len(page.of("frame")), len(live.script())
    with stopped(live.simulating()):
        page.tab.get_by_role("button", name="Analyse", exact=True).click()
        page.tab.get_by_role("button", name="Cancel").click()
        page.until(lambda: len(page.of("frame")) > shown, "the state before")
    assert page.frame["number"] == number and len(live.script()) == lines
    with stopped(live.simulating()):
        page.tab.get_by_role("button", name="Undo", exact=True).click()
        page.until(lambda: page.of("busy")[-1]["what"] == "undo", "that it takes long")
    page.until(lambda: page.frame["columns"]["event"] == "undo", "the undo")
    live.end()
    done = [event["do"] for event in live.script()]
    assert done[:2] == ["hole", "arc"] and done[-1] == "undo" and {"rotate", "scale", "smooth"} <= {*done}
    assert page.refusals() == [ENDED_BY_HAND] and not page.faults
    live.assert_replays(page.frames())
    with Recording(recorded) as recording:
        assert recording.n == number + 1


def slept(page, live, seconds, who):
    """The page, the server or what simulates stands still for a while, in the middle of a drag."""
    if who == "page":
        browser = page.tab.context.new_cdp_session(page.tab)
        browser.send("Page.setWebLifecycleState", {"state": "frozen"})
        page.tab.wait_for_timeout(1000 * seconds)
        browser.send("Page.setWebLifecycleState", {"state": "active"})
        return
    with stopped(live.process.pid if who == "server" else live.simulating()):
        page.tab.wait_for_timeout(1000 * seconds)


@pytest.mark.weekly
@pytest.mark.parametrize("seconds", [0.3, 65.0])
def test_a_machine_that_sleeps_in_the_drag_goes_on(bracket_session, opened, seconds):
    live = bracket_session()
    page = opened(live)
    x, y = page.place([ROUND])
    page.drag((x, y), (9.0, 6.0), release=False)
    for number, who in enumerate(("page", "server", "simulation"), start=1):
        slept(page, live, seconds, who)
        page.until(lambda: page.tab.locator("#connection").inner_text() == "connected", "the socket")
        page.until(lambda: page.frame["held"], "what is held")
        page.tab.mouse.move(x + 9 + 2 * number, y + 6)
        page.until(lambda last=4 + number: len(live.script()) >= last, f"an answer after the sleep of the {who}")
    page.release()
    live.end()
    done = [event["do"] for event in live.script()]
    assert done[0] == "press" and done[-1] == "release" and done.count("release") == 1
    live.assert_replays(page.frames())
