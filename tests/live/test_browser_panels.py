"""Panels and picture in a browser: each event by its form, names for screen readers, colours as in reports."""

import re
from pathlib import Path

import numpy as np
import pytest
from browser import BrowserPage, context_of
from live_worker import BRACKET, COARSE
from matplotlib import pyplot
from PIL import Image

import restshape
from restshape.outputs.si_numbers import si
from restshape.replay.recording.recording import Recording
from restshape.report.drawing import Drawing
from restshape.report.scenery import scenery

AXE = Path(__file__).parents[2] / "node_modules" / "axe-core" / "axe.min.js"
FORMS = [
    {"do": "press", "on": "window", "at": "0.09, 0.062"},
    {"do": "drag", "to": "92 mm, 0.062"},
    {"do": "release"},
    {"do": "rotate", "on": "window", "by": "5 deg"},
    {"do": "scale", "on": "window", "factor": "1.05", "frames": "2"},
    {"do": "set", "key": "material.steel.thickness", "value": "9 mm"},
    {"do": "insert", "on": "top", "name": "peak", "s": "0.5"},
    {"do": "delete", "on": "peak"},
    {"do": "hole", "name": "vent", "center": "220 mm, 70 mm", "radius": "12 mm"},
    {"do": "arc", "on": "tip", "bulge": "0.05"},
    {"do": "pull", "on": "window.1"},
    {"do": "release"},
    {"do": "smooth", "on": "window.1", "strength": "0.3"},
    {"do": "idle"},
    {"do": "analyse"},
    {"do": "undo"},
    {"do": "redo"},
]
"""As they are typed."""


def test_each_event_can_be_done_by_its_form(bracket_session, opened):
    live = bracket_session()
    page = opened(live)
    assert {form["do"] for form in FORMS} == set(page.of("welcome")[-1]["events"])
    choice = page.tab.get_by_label("event", exact=True)
    for form in FORMS:
        choice.select_option(form["do"])
        for name, text in form.items():
            if name != "do":
                page.tab.locator("form.event").get_by_label(re.compile(rf"^{name}( \(optional\))?$")).fill(text)
        page.tab.locator("form.event button[type=submit]").click()
        page.until(lambda form=form: page.events()[-1]["event"]["do"] == form["do"], "the event of the form")
        page.settle()
        assert not page.refusals(), form
    # What is wrong is said in the form, and nothing is sent.
    asked = len(page.events())
    choice.select_option("scale")
    page.tab.locator("form.event").get_by_label("on", exact=True).fill("window")
    page.tab.locator("form.event button[type=submit]").click()
    assert page.tab.locator("form.event").get_by_role("alert").inner_text() == "factor is needed"
    live.end()
    script = live.script()
    assert [event["do"] for event in script] == [form["do"] for form in FORMS] and len(page.events()) == asked
    for event, form in zip(script, FORMS, strict=True):
        assert form.keys() <= event.keys() and all(
            event[key] == form[key] for key in form.keys() & {"on", "name", "key"}
        )
    assert not page.faults
    live.assert_replays(page.frames())


def test_a_slider_that_is_dragged_is_undone_at_once(bracket_session, opened):
    live = bracket_session()
    page = opened(live)
    page.tab.get_by_role("searchbox").fill("thickness")
    text = page.tab.get_by_label("material.steel.thickness", exact=True)
    slider = page.tab.get_by_label("material.steel.thickness, slider", exact=True)
    asked = len(page.events())
    slider.focus()
    for _ in range(3):
        slider.press("ArrowRight")
    page.until(lambda: len(page.events()) > asked, "the slide")
    page.settle()
    slid = page.events()[-1]["event"]
    assert (slid["do"], slid["key"]) == ("set", "material.steel.thickness")
    page.until(lambda: text.input_value() == str(page.events()[-1]["event"]["value"]), "the text beside the slider")
    # A drag of the slider is one gesture, and so one undo, also of a page that is loaded again.
    before, count = text.input_value(), len(live.script())
    box = slider.bounding_box()
    mouse, middle = page.tab.mouse, box["y"] + box["height"] / 2
    mouse.move(box["x"] + box["width"] / 2, middle)
    mouse.down()
    for step in range(1, 4):
        mouse.move(box["x"] + box["width"] * (0.5 + 0.1 * step), middle)
        page.settle()
    mouse.up()
    page.settle()
    slid = len(live.script()) - count
    assert slid >= 3 and text.input_value() != before
    heard = len(page.of("frame"))
    page.tab.reload()
    page.until(lambda: len(page.of("frame")) > heard, "the frame after a reload")
    page.tab.get_by_role("searchbox").fill("thickness")
    page.press("Undo")
    page.until(lambda: text.input_value() == before, "the number before the drag")
    assert [event["do"] for event in live.script()[count:]] == [*slid * ["set"], "undo"]
    page.press("Redo")
    page.until(lambda: text.input_value() != before, "the drag again")
    page.settle()
    live.end()
    live.assert_replays(page.frames())


def test_numbers_are_typed_and_stay_what_they_are_where_they_are_refused(bracket_session, context):
    live = bracket_session()
    page = BrowserPage(context, f"{live.address}?draw=card")
    page.tab.get_by_role("searchbox").fill("thickness")
    text = page.tab.get_by_label("material.steel.thickness", exact=True)
    slider = page.tab.get_by_label("material.steel.thickness, slider", exact=True)
    text.fill("9 mm")
    text.press("Enter")
    page.until(lambda: page.events()[-1]["event"].get("value") == "9 mm", "what is typed")
    page.settle()
    assert not page.refusals() and not page.frame["columns"].get("refused")
    page.until(lambda: slider.get_attribute("aria-valuetext") == text.input_value() == "9 mm", "what was taken")
    text.fill("-1 mm")
    text.press("Enter")
    why = page.until(lambda: page.frame["columns"].get("refused"), "a refusal")
    page.until(lambda: why in page.log.inner_text(), "why")
    page.until(lambda: text.get_attribute("aria-invalid") == "true", "what is wrong is marked")
    assert page.tab.locator(".number .wrong:visible").inner_text().startswith("-1 mm: a thickness is greater")
    # The quantities stay as they were, and the words at the foot of the picture as long as the refusal holds.
    values = page.tab.locator(".quantities .value")
    page.until(lambda: all("as before" in one and "–" not in one for one in values.all_inner_texts()), "as before")
    assert page.tab.locator("#said").inner_text() == why
    boxes = [page.tab.locator(one).bounding_box() for one in ("#beside", "#tools")]
    assert boxes[0]["y"] > boxes[1]["y"] + boxes[1]["height"]
    text.blur()
    page.until(lambda: text.input_value() == "9 mm", "the number as it is")
    page.press("Idle")
    page.until(lambda: not page.tab.locator("#said").inner_text(), "words that go")
    assert not page.tab.locator(".number .wrong:visible").count()
    page.until(lambda: "as before" not in "".join(values.all_inner_texts()), "quantities of the frame")
    live.end()
    page.until(lambda: page.tab.locator("#connection").inner_text() == "the session has ended", "the end")
    assert f"its script is in {live.out}" in page.log.inner_text()
    assert [event.get("value") for event in live.script()][-3:] == ["9 mm", "-1 mm", None] and not page.faults
    live.assert_replays(page.frames())


@pytest.mark.skipif(not AXE.exists(), reason="axe-core is not here: make setup installs it")
def test_screen_readers_find_names_and_eyes_find_contrast(browser, bracket_session):
    live = bracket_session()
    page = BrowserPage(context_of(browser), live.address)
    page.drag(page.place(["hole"]), (8.0, 4.0))
    page.tab.evaluate(AXE.read_text())
    for colours in ("light", "dark"):
        page.tab.emulate_media(color_scheme=colours)
        done, found = page.tab.evaluate("axe.run().then(({ passes, violations }) => [passes, violations])")
        assert {"button-name", "color-contrast", "label", "aria-roles"} <= {one["id"] for one in done + found}
        said = [f"{one['id']}: {node['html'][:200]} {node['failureSummary']}" for one in found for node in one["nodes"]]
        assert not said, (colours, "\n".join(said))
    for width in (360, 390, 760, 1280, 2560):
        page.tab.set_viewport_size({"width": width, "height": 700})
        assert page.tab.evaluate("document.documentElement.scrollWidth") <= width
        shown = page.tab.locator("#canvas").bounding_box()
        assert shown["width"] > 0.5 * min(width, 760) and shown["height"] > 250, (width, shown)
    live.end()


GOAL = "goal.straight={polyline=[[0, 0], ['300 mm', '40 mm'], ['300 mm', '100 mm'], [0, '120 mm']]}"
SOFT = ("material.steel.E='50 kPa'", "effects.gravity.g=[0, 0]", "loads.weight.force=[0, '-1 N']")
"""With displacements of more than half the size, which would be drawn smaller than they are."""


def test_a_shape_beside_its_goal_is_drawn_where_it_is(session, opened):
    live = session(BRACKET, settings=(*COARSE, *SOFT, GOAL))
    page = opened(live)
    scale, words = page.tab.get_by_label("scale of the deformation", exact=True), page.tab.locator("#bar .extremes")
    page.until(lambda: " to " in words.inner_text(), "the picture")
    assert "displacements" not in words.inner_text() and scale.input_value() == "1"
    # Another scale can be chosen, and is kept.
    scale.fill("5")
    scale.press("Enter")
    page.press("Idle")
    page.until(lambda: "displacements × 5" in words.inner_text(), "what was chosen")
    live.end()
    assert not page.faults


SIDE = (60.0, 120.0)
"""A place beside the shape."""


def pixels_of_places(page):
    """A function from places [m] (n, 2) to pixels of the canvas: by a drag, of which the events say where it went."""
    x, y = page.place(["hole"])
    page.drag((x, y), (32.0, -8.0), steps=1)
    press, drag = (one["event"] for one in page.events()[:2])
    metres = (drag["to"][0] - press["at"][0]) / 32.0
    canvas = page.tab.locator("#canvas").bounding_box()
    start = np.array([x - canvas["x"], y - canvas["y"]])
    return lambda places: start + (places - press["at"]) / metres * [1.0, -1.0]


def probes(X, cells, values):
    """Ten places (10, 2) [m] with values from one end of the colours to the other: middles of cells."""
    low, range_ = values.min(), np.ptp(values)
    calm = np.flatnonzero(np.ptp(values, axis=1) < 0.3 * range_)
    share = (values[calm].mean(axis=1) - low) / range_
    nearest = [calm[np.abs(share - wanted).argmin()] for wanted in np.linspace(0.03, share.max(), 10)]
    return X[cells[nearest, :3]].mean(axis=1)


def colours_at(picture, pixels):
    """Of pixels (n, 2) the colours (n, 3)."""
    column, row = np.round(pixels - 0.5).astype(int).T
    return picture[row, column, :3].astype(int)


def report_colours(recording, looks, places):
    """The colours that a report has at places (n, 2) [m]."""
    figure, axes = pyplot.subplots(figsize=(8, 5), dpi=100)
    drawing = Drawing(axes, looks, mesh=False)
    drawing.show(recording, recording.n - 1)
    for mark in (*drawing.marks, drawing.crosses):
        mark.set_visible(False)
    figure.canvas.draw()
    picture = np.asarray(figure.canvas.buffer_rgba())
    pixels = axes.transData.transform(looks.unit[0] * places)
    pyplot.close(figure)
    return colours_at(picture, [0.0, len(picture)] + pixels * [1.0, -1.0])


def png(page):
    """The picture that a page saves, RGB."""
    with page.tab.expect_download() as download:
        page.tab.get_by_role("button", name="PNG").click()
    return np.asarray(Image.open(download.value.path()).convert("RGB"))


@pytest.mark.weekly
def test_a_graphics_card_draws_what_is_drawn_without_one(bracket_session, opened, context):
    live = bracket_session()
    page, by_card = opened(live), BrowserPage(context, f"{live.address}?draw=card")
    apart = np.abs(png(page).astype(int) - png(by_card)).max(axis=2)
    assert apart.size > 100_000 and (apart > 16).mean() < 1e-3 and (apart > 2).mean() < 0.03
    live.end()


@pytest.mark.parametrize("means", ["processor", pytest.param("card", marks=pytest.mark.weekly)])
def test_the_picture_is_that_of_a_report(bracket_session, context, tmp_path, means):
    """The same extremes in words, and the same colours at ten places."""
    live = bracket_session()
    page = BrowserPage(context, f"{live.address}?draw={means}")
    for name in ("edges of the mesh", "outline before deformation", "what can be held", "marks"):
        page.tab.get_by_label(name, exact=True).uncheck()
    page.tab.get_by_role("button", name="1 : 1").click()
    pixels = pixels_of_places(page)
    page.tab.mouse.click(*SIDE)  # nothing is selected
    picture = png(page)
    words = page.tab.locator("#bar .extremes").inner_text()
    live.end()

    # The same edit as a recording, as a report draws its last frame.
    scene = restshape.load(BRACKET, *COARSE)
    path = tmp_path / "again.vtkhdf"
    frames = list(restshape.replay(scene, restshape.load_script(live.out, scene), out=path))
    with Recording(path) as recording:
        last = len(frames) - 1
        looks = scenery(recording, scale=1.0, frames=[last])
        X, cells = recording.mesh(last)
        values = looks.field.values(recording, last, cells)
        places = probes(X, cells, values)
        seen, drawn = colours_at(picture, pixels(places)), report_colours(recording, looks, places)
    # The page keeps zeros at the end, so that its words stand still.
    assert (
        re.sub(r"\d+\.\d+", lambda one: f"{float(one[0]):g}", words)
        == f"{si(np.nanmin(values), 'Pa', 4)} to {si(np.nanmax(values), 'Pa', 4)}"
    )
    # What was left out does not come back with the next frame: right of the corner there is nothing.
    column, row = np.round(pixels(np.array([0.3, 0.1]))).astype(int)
    assert (picture[row - 6 : row + 7, column + 2 : column + 8] == picture[2, 2]).all()
    assert np.ptp(seen, axis=0).max() > 100
    np.testing.assert_allclose(seen, drawn, atol=8)
