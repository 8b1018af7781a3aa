"""What an application has to say is seen while a script is played: a script by itself, and that of a recording."""

import re
from pathlib import Path

import pytest

import restshape
from restshape.scene.edit_script import load_script

FURNITURE = Path(__file__).parents[2] / "apps" / "furniture"
SCENE = FURNITURE / "scenes" / "table.toml"
EDITS = """{"format": "restshape-edits", "version": 1, "units": "m"}
{"t": 0.0, "do": "press", "on": "leg-4", "parameter": "length y"}
{"t": 0.1, "do": "drag", "by": 0.02, "frames": 3}
{"t": 0.2, "do": "release"}
{"t": 0.3, "do": "press", "on": "leg-4", "parameter": "length y"}
{"t": 0.4, "do": "drag", "by": 0.025, "frames": 90}
{"t": 1.9, "do": "release"}
"""
LET_GO, DRAGS, LAST = 5, 8, 97
"""Frames: the hand has let go; it drags again; the last one."""
RANGE, FORCE = "or beyond", r"\d N$"
SEEN = """() => ({
    words: [...document.querySelectorAll("#labels span")]
        .filter((one) => one.checkVisibility({ visibilityProperty: true })).map((one) => one.textContent),
    offers: [...document.querySelectorAll("ul.offers li button")]
        .filter((one) => one.checkVisibility()).map((one) => one.textContent),
    place: document.querySelector(".player .place").textContent,
    plays: document.querySelector(".player button").textContent === "Pause",
})"""
"""What can be read in the page."""
WATCH = f"""() => {{
    const seen = {SEEN};
    window.watched = [];
    setInterval(() => watched.push(seen()), 20);
}}"""


def has(seen, pattern):
    """Whether a word in the picture is of a pattern."""
    return any(re.search(pattern, word) for word in seen["words"])


@pytest.fixture(params=["script", "recording"])
def played(request, session, tmp_path):
    """A session that plays: the hand changes the length of a leg, along which there is a range; before, it is offered
    what would help."""
    (edits := tmp_path / "edits.jsonl").write_text(EDITS)
    if request.param == "script":
        return session(SCENE, words=("--edits", str(edits)))
    scene, path = restshape.load(SCENE), tmp_path / "session.vtkhdf"
    for _ in restshape.replay(scene, load_script(edits, scene), out=path):
        pass
    return session(path)


def test_ranges_suggestions_and_forces_are_seen_at_each_frame_that_is_played(played, opened):
    page = opened(played)
    assert page.of("welcome")[-1]["player"]

    def seen():
        return page.tab.evaluate(SEEN)

    def until(what, condition):
        page.until(lambda: condition(seen()), f"{what}: {seen()}")

    press = page.tab.get_by_role("button", name="▸").click
    scrub = page.tab.get_by_role("slider", name="frame", exact=True).fill
    until("suggestions and forces before the first event", lambda now: now["offers"] and has(now, FORCE))
    assert not has(seen(), RANGE)
    for number in (1, 2):
        press()
        until("one frame on", lambda now, number=number: now["place"].startswith(f"frame {number} "))
    until("the range and forces while the hand drags", lambda now: has(now, RANGE) and has(now, FORCE))
    assert not seen()["offers"]
    scrub(str(LAST))
    until("forces at the end", lambda now: now["place"].startswith(f"frame {LAST} ") and has(now, FORCE))
    assert not has(seen(), RANGE)
    scrub(str(LET_GO))
    until("suggestions after the hand has let go", lambda now: now["offers"] and not has(now, RANGE))
    page.tab.get_by_label("speed").select_option("0.5")
    page.tab.evaluate(WATCH)
    page.tab.get_by_role("button", name="Play").click()
    until("the drag while it plays", lambda now: int(now["place"].split()[1]) > DRAGS)
    page.tab.get_by_role("button", name="Pause").click()
    until("a pause", lambda now: not now["plays"])
    until("the range in a pause", lambda now: has(now, RANGE) and has(now, FORCE) and not now["offers"])
    watched = [now for now in page.tab.evaluate("watched") if now["plays"]]
    assert any(has(now, RANGE) and has(now, FORCE) for now in watched)
    played.end()
    assert not page.faults
