"""A drag with the mouse in each application: what the page has shown is what the recorded script replays to."""

from pathlib import Path

import pytest

from restshape.application import applications

ROLES = ("plank", "hole", "body", "vertex", "support", "control")
APPS = Path(__file__).parents[2] / "apps"
TEMPLATES = {
    name: one.folder / "template" / "scene.toml"
    for name, one in sorted(applications().items())
    if one.folder.is_relative_to(APPS)
}


EACH_DAY = ("solid", "furniture", "couture")
"""In the plane, in space, and one that goes on by itself."""
NAMES = [name if name in EACH_DAY else pytest.param(name, marks=pytest.mark.weekly) for name in TEMPLATES]


@pytest.mark.parametrize("name", NAMES)
def test_a_drag_with_the_mouse_replays_to_what_was_seen(name, session, opened):
    live = session(TEMPLATES[name])
    page = opened(live)
    page.drag(page.place(ROLES), (14.0, 9.0))
    page.press("Undo")
    live.end()
    kinds = [event["do"] for event in live.script()]
    assert kinds[0] == "press" and kinds.count("drag") == 3 and "release" in kinds and "undo" in kinds
    assert not page.refusals() and not page.faults
    live.assert_replays(page.frames())


def test_a_point_of_cloth_is_held_in_space_and_let_go(session, opened):
    live = session(TEMPLATES["couture"])
    page = opened(live)
    place = page.place(["cloth"])
    page.tab.mouse.move(*place)
    page.until(lambda: page.tab.locator("#canvas").get_attribute("title") == "cloth", "what is under the pointer")
    page.drag(place, (0.0, -24.0))
    page.press("Undo")
    live.end()
    press, *drags = (event for event in live.script() if event["do"] in ("press", "drag"))
    assert press["on"] == "cloth" and len(press["at"]) == 2 and len(drags) == 3
    heights = [drag["to"][2] for drag in drags]
    assert heights[0] < heights[1] < heights[2]
    assert not page.refusals() and not page.faults
    live.assert_replays(page.frames())


def test_a_point_of_cloth_is_held_by_keys(session, opened):
    live = session(TEMPLATES["couture"])
    page = opened(live)
    canvas = page.tab.locator("#canvas")
    canvas.focus()
    page.tab.locator("details.things summary").click()
    page.tab.locator("details.things").get_by_role("button", name="cloth", exact=True).click()
    canvas.focus()
    for key in ("Enter", "PageUp", "PageUp", "Escape"):
        canvas.press(key)
        page.settle()
    page.until(lambda: page.events()[-1]["event"]["do"] == "release", "the release")
    live.end()
    press, *drags = (event for event in live.script() if event["do"] in ("press", "drag"))
    assert press["on"] == "cloth" and press["at"] == pytest.approx([0.15, 0.15], abs=0.02)
    assert drags[-1]["to"][2] > drags[0]["to"][2] and not page.refusals() + page.faults
    live.assert_replays(page.frames())


@pytest.mark.weekly
def test_a_suggestion_is_taken_and_slid_along(session, opened):
    live = session(APPS / "furniture" / "scenes" / "shelf-1.toml")
    page = opened(live)
    page.drag(page.place(["plank"], "upright-1"), (50.0, 30.0))
    offer = page.tab.locator("ul.offers li").first
    offer.get_by_role("button").click()
    page.until(lambda: page.events()[-1]["event"]["do"] == "choose", "the choice")
    page.settle()
    assert page.frame["columns"]["constraint_status"] == "holds"
    slider = page.tab.locator("ul.offers input[type=range]:visible").first
    slider.focus()
    for _ in range(3):
        slider.press("ArrowRight")
        page.settle()
    page.until(lambda: page.events()[-1]["event"]["do"] == "slide", "the slide")
    page.settle()
    live.end()
    assert [event["do"] for event in live.script()][-2:] == ["slide", "slide"] and not page.refusals() + page.faults
    live.assert_replays(page.frames())
