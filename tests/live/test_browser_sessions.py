"""What a person's session in a browser goes through: pages that are loaded again, close, look, lose their socket."""

import os
import signal

import numpy as np
import pytest
from browser import SECONDS, BrowserPage, Session, context_of, rest
from live_worker import BRACKET, COARSE, replayed

import restshape
from restshape.application import applications

ROUND = "hole"
HELD = ["press", *3 * ["drag"], "release"]
KEEP_SOCKETS = """window.sockets = [];
window.WebSocket = class extends WebSocket { constructor(...words) { super(...words); window.sockets.push(this); } };"""

HEAR_TONES = """window.heard = [];
const start = OscillatorNode.prototype.start;
OscillatorNode.prototype.start = function (at) { heard.push(this.frequency.value); start.call(this, at); };"""

EDITS = """{"format": "restshape-edits", "version": 1, "units": "mm"}
{"t": 0.0, "do": "press", "on": "window", "at": [90, 60]}
{"t": 0.1, "do": "drag", "path": [[92, 60], [94, 61], [96, 62], [98, 62]]}
{"t": 0.5, "do": "release"}
"""


def without_times(frame):
    """A frame as two pages must have it."""
    columns = {name: value for name, value in frame["columns"].items() if not name.startswith("ms")}
    return frame["number"], columns, frame["held"], frame["limits"]


def same_picture(one, other):
    """Two pages show the same."""
    assert one.arrays.keys() == other.arrays.keys()
    for key, values in one.arrays.items():
        np.testing.assert_array_equal(values, other.arrays[key], str(key))


def test_pages_that_come_again_close_and_look(bracket_session, context, opened):
    live = bracket_session()
    page = opened(live)
    start = page.arrays["outline", "points"].copy()
    at = page.place([ROUND])
    page.drag(at, (12.0, 6.0), release=False)
    before = page.frame
    assert before["held"] and not np.array_equal(start, page.arrays["outline", "points"])

    # A second page looks, and says so; what it sees is the same.
    looker = BrowserPage(context, live.address)
    assert looker.of("welcome")[-1]["role"] == "looker"
    assert without_times(looker.frame) == without_times(before)
    looker.until(lambda: "another page has the hand" in (looker.drag_in_vain(at) or looker.beside.inner_text()))
    assert not looker.events()
    same_picture(page, looker)

    # The page is loaded again in the drag: it has the hand, and all is as it was.
    heard = len(page.of("frame"))
    page.tab.reload()
    page.until(lambda: len(page.of("frame")) > heard, "the frame after a reload")
    assert page.of("welcome")[-1]["role"] == "hand" and without_times(page.frame) == without_times(before)
    same_picture(page, looker)
    looker.tab.close()

    # It is closed in the drag: one that looks asks for the hand, takes hold again, and undoes both drags.
    last = opened(live)
    ask = last.tab.get_by_role("button", name="Take the hand")
    ask.click()
    last.until(lambda: "another page has the hand" in last.log.inner_text(), "why it has not")
    page.tab.close()
    last.until(lambda: "no page has the hand" in last.log.inner_text(), "that it is free")
    ask.click()
    last.until(lambda: last.of("role") and last.of("role")[-1]["role"] == "hand", "the hand")
    assert last.frame["held"]
    last.drag(last.place([ROUND]), (5.0, -8.0))
    last.tab.keyboard.press("Control+z")
    last.settle()
    last.press("Undo")
    np.testing.assert_array_equal(last.arrays["outline", "points"], start)
    live.end()
    kinds = [event["do"] for event in live.script()]
    assert kinds == ["press", *3 * ["drag"], "release", "press", *3 * ["drag"], "release", "undo", "undo"]
    live.assert_replays(page.frames() | last.frames())
    assert not page.refusals() + last.refusals() and not page.faults + looker.faults + last.faults


def test_a_lost_socket_comes_back_in_the_drag(bracket_session, context):
    context.add_init_script(KEEP_SOCKETS)
    live = bracket_session()
    page = BrowserPage(context, live.address)
    at = page.place([ROUND])
    page.drag(at, (12.0, 6.0), release=False)
    held = page.frame["held"]["at"]
    welcomes = len(page.of("welcome"))
    page.tab.evaluate("sockets.at(-1).close()")
    page.until(lambda: len(page.of("welcome")) > welcomes and page.frame["held"], "the socket that comes back")
    assert page.of("welcome")[-1]["role"] == "hand" and page.frame["held"]["at"] == held
    page.tab.mouse.move(at[0] + 20, at[1])
    page.settle()
    assert page.frame["held"]["at"] != held
    page.release()
    live.end()
    live.assert_replays(page.frames())
    assert [event["do"] for event in live.script()] == ["press", *4 * ["drag"], "release"] and not page.faults


def test_a_simulation_that_is_killed_in_the_drag_begins_again(bracket_session, opened):
    live = bracket_session()
    page = opened(live)
    at = page.place([ROUND])
    page.drag(at, (12.0, 6.0), release=False)
    before = page.frame
    os.kill(live.simulating(), signal.SIGKILL)
    page.until(lambda: page.of("lost"), "what the page says of it")
    page.until(lambda: page.heard.index(page.of("lost")[-1]) < page.heard.index(page.frame), "a frame again")
    assert without_times(page.frame)[:3] == without_times(before)[:3]
    page.tab.mouse.move(at[0] + 20, at[1])
    page.until(lambda: page.frame["held"]["at"] != before["held"]["at"], "the drag that goes on")
    page.release()
    live.end()
    assert [event["do"] for event in live.script()] == ["press", *4 * ["drag"], "release"] and not page.faults
    live.assert_replays(page.frames())


def test_a_refused_edit_says_why_beside_the_hand_and_the_drag_goes_on(bracket_session, opened):
    live = bracket_session()
    page = opened(live)
    x, y = page.place([ROUND])
    mouse = page.tab.mouse
    mouse.move(x, y)
    mouse.down()
    # Of the hole over the left edge, and back.
    mouse.move(x - 200, y)
    page.settle()
    assert page.frame["columns"]["refused"] and page.beside.get_attribute("data-kind") == "refused"
    page.until(lambda: page.beside.inner_text() == page.frame["columns"]["refused"], "the reason beside the hand")
    box, hand = page.beside.bounding_box(), page.frame["held"]
    assert abs(box["x"] - (x - 200)) < 150 and abs(box["y"] - y) < 150
    assert page.frame["columns"]["refused"] in page.log.inner_text()
    mouse.move(x + 10, y)
    page.settle()
    assert not page.frame["columns"].get("refused") and page.frame["held"] != hand
    page.release()
    live.end()
    live.assert_replays(page.frames())


def test_a_played_script_is_taken_over_by_the_hand(bracket_session, opened, tmp_path):
    (edits := tmp_path / "edits.jsonl").write_text(EDITS)
    live = bracket_session("--edits", str(edits))
    page = opened(live)
    assert page.of("welcome")[-1]["player"]
    for number in (1, 2, 3):
        page.tab.get_by_role("button", name="▸").click()
        page.until(lambda number=number: page.frame["number"] == number, "one frame on")
    # A jump to the end, and back to a frame in the drag, from which the hand goes on.
    scrub = page.tab.get_by_role("slider", name="frame", exact=True)
    for frame in (6, 2):
        scrub.fill(str(frame))
        page.until(lambda frame=frame: page.frame["number"] == frame, "the frame of the jump")
    page.tab.get_by_role("button", name="Take over").click()
    page.until(lambda: not page.of("welcome")[-1]["player"], "the hand")
    played = len(page.of("frame"))
    page.drag(page.place([ROUND]), (0.0, -9.0))
    live.end()
    script = live.script()
    assert [event["do"] for event in script[:1] + script[-1:]] == ["press", "release"]
    # The player's later frames are not of the hand's script, and a page may leave out a frame that a newer one passed.
    of_the_hand = {one["number"]: one["columns"] for one in page.of("frame")[played:]}
    assert max(of_the_hand) > 3 and not page.faults
    live.assert_replays({number: row for number, row in page.frames().items() if number <= 2} | of_the_hand)


def test_a_finger_and_keys_edit_on_a_phone(browser, bracket_session):
    live = bracket_session()
    phone = context_of(browser, viewport={"width": 390, "height": 760}, has_touch=True, is_mobile=True)
    page = BrowserPage(phone, live.address)
    assert page.tab.evaluate("document.documentElement.scrollWidth") <= 390
    shown = page.tab.locator("#canvas").bounding_box()
    assert shown["width"] > 300 and shown["height"] > 200
    x, y = page.place([ROUND])
    touch = phone.new_cdp_session(page.tab)

    def finger(kind, *places):
        points = [{"x": x, "y": y} for x, y in places]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    finger("touchStart", (x, y))
    for step in (6, 12):
        finger("touchMove", (x + step, y))
        page.until(lambda step=step: len(page.events()) >= 1 + step // 6)
        page.settle()
    finger("touchEnd")
    page.until(lambda: page.events()[-1]["event"]["do"] == "release")
    page.settle()
    # By keys the first vertex, to the right and up.
    page.tab.locator("#canvas").focus()
    for key in ("Tab", "Enter", "ArrowRight", "ArrowUp", "Escape"):
        page.tab.keyboard.press(key)
        page.settle()
    assert "is let go" in page.tab.locator("#said").inner_text()
    # What is needed can be come by: the panels unfold.
    page.tab.get_by_role("button", name="Panels").click()
    page.tab.get_by_role("button", name="Undo", exact=True).scroll_into_view_if_needed()
    page.press("Undo")
    assert page.tab.evaluate("document.documentElement.scrollWidth") <= 390
    live.end()
    kinds = [event["do"] for event in live.script()]
    assert kinds == [*("press", "drag", "drag", "release"), *("press", "drag", "drag", "release"), "undo"]
    assert not page.faults
    live.assert_replays(page.frames())


def test_a_browser_without_webgl_says_so_and_its_panels_work(context, bracket_session):
    context.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    live = bracket_session()
    page = BrowserPage(context, live.address)
    said = page.tab.get_by_role("alert").first
    assert "no WebGL 2" in said.inner_text()
    page.press("Idle")
    assert page.frame["columns"]["event"] == "idle" and not page.faults
    live.end()
    assert [event["do"] for event in live.script()] == ["idle"]


def test_the_tone_is_heard_after_a_blow(context, session):
    context.add_init_script(HEAR_TONES)
    sounding = next(one for one in applications().values() if one.marks.struck)
    live = session(sounding.folder / "template" / "scene.toml")
    page = BrowserPage(context, live.address)
    strike = page.tab.get_by_role("button", name="strike", exact=True)
    strike.click()
    (tone,) = page.until(lambda: page.of("struck"), "the blow")
    strike.click()
    heard = page.until(lambda: page.tab.evaluate("heard"), "a tone")
    wanted = np.asarray(tone["tone"]["frequencies"])
    assert all(np.min(np.abs(wanted / one - 1)) < 1e-5 for one in heard)
    # A near miss strikes the nearest place, where the mallet is drawn.
    page.tab.get_by_role("button", name="strike at …").click()
    assert page.tab.locator("#said").inner_text().startswith("click on the bar where the mallet strikes")
    box = page.tab.locator("#canvas").bounding_box()
    page.tab.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.6 * box["height"])
    at = page.until(lambda: [one["at"] for one in page.said if "at" in one], "the place")[0]
    struck = page.until(lambda: page.of("struck")[2:], "the blow beside the bar")[0]["tone"]
    struck, moved = struck["at"], struck["moved"]
    assert len(moved) == 3 and abs(moved[2]) > 0
    assert at[1] < -0.005 and 0 <= struck[1] < 0.003 and abs(struck[0] - at[0]) < 0.01
    assert page.tab.locator("#labels span", has_text="mallet").count() == 1
    assert not page.faults and not page.of("refused")
    live.end()


def test_a_session_that_ends_before_its_first_frame_says_so(bracket_session, context):
    live = bracket_session()
    simulating = live.simulating()
    os.kill(simulating, signal.SIGSTOP)
    tab = context.new_page()
    tab.goto(live.address)
    tab.get_by_text("the simulation starts").wait_for()
    os.kill(simulating, signal.SIGKILL)
    tab.get_by_text("The session has ended before its first frame.").wait_for()
    assert not tab.locator(".busy").is_visible()
    assert live.process.wait(SECONDS) == 128 + signal.SIGKILL


@pytest.mark.weekly
@pytest.mark.mpi
def test_two_ranks_have_a_page(start_restshape, opened, tmp_path):
    def start(*words):
        return start_restshape(*words, ranks=2)

    live = Session(start, BRACKET, tmp_path / "session.jsonl", settings=COARSE)
    page = opened(live)
    page.drag(page.place([ROUND]), (12.0, 6.0))
    page.press("Undo")
    # What takes long is cancelled after the frame in work, and left out.
    script, last = live.script(), page.frame["number"]
    rest(page, 50_000)
    page.tab.get_by_role("button", name="Cancel").click()
    page.until(lambda: page.frame["number"] == last, "the state before")
    page.press("Restart")
    page.drag(page.place([ROUND]), (12.0, 6.0))
    assert live.script()[: len(script)] == script and len(live.script()) == len(script) + 5
    live.end(code=1)  # mpiexec has no other one for Ctrl-C
    assert [event["do"] for event in live.script()] == [*HELD, "undo", *HELD] and not page.faults
    # One rank alone gets the same quantities.
    again = replayed(restshape.load(BRACKET, *COARSE), live.out)
    seen = page.frames()
    for number, frame in enumerate(again):
        for name in (name for name in frame if name.startswith("q_")):
            assert seen[number][name] == pytest.approx(frame[name], rel=1e-5), (number, name)
