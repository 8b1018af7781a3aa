"""Pictures mark the singular places of the frame that is drawn: those that an edit makes, moves and takes away."""

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from small_scenes import HEAD, STEEL, block, write_scene, write_script

from restshape.cli.main import main
from restshape.replay.recorded_places import PLACES_BYTES, decode_places, encode_places
from restshape.replay.recording.recording import Recording
from restshape.replay.singular_notes import MARK
from restshape.report import quantity_panels
from restshape.report.drawing import Drawing
from restshape.report.frames import caption
from restshape.report.scenery import scenery
from restshape.report.tables import singular

HELD = '\n[supports.wall]\non = "left"\nfix = ["x"]\n\n[supports.pin]\non = "a"\nfix = ["y"]\n'
PULLED = '\n[loads.pull]\non = "right"\ntraction = ["30 MPa", 0]\n[mesh]\nsize = 0.25\n'
ASKED = '\n[quantities]\npeak = { stress = "von_mises" }\nstretch = { displacement = "x", at = "right" }\n'
NOTCH = [
    {"do": "hole", "name": "notch", "polygon": [[0.8, 0.4], [1.2, 0.4], [1.2, 0.7], [0.8, 0.7]]},
    {"do": "press", "on": "notch"},
    {"do": "drag", "to": [1.1, 0.55], "frames": 3},
    {"do": "release"},
    {"do": "delete", "on": "notch"},
]
CORNERS = np.array([[0.8, 0.4], [0.8, 0.7], [1.2, 0.4], [1.2, 0.7]])


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("notch")
    scene = write_scene(folder, HEAD + block(2.0, 1.0) + STEEL + HELD + PULLED + ASKED)
    script, out = write_script(folder, NOTCH), folder / "a.vtkhdf"
    assert main(["replay", str(scene), "--edits", str(script), "--out", str(out)]) == 0
    scene.unlink()
    script.unlink()
    with Recording(out) as recording:
        yield recording


def crossed(recording, i):
    """Where the picture of a frame has crosses, at rest [m], sorted."""
    common = scenery(recording, scale=0.0)
    drawing = Drawing(Figure().subplots(), common)
    drawing.show(recording, i)
    found = np.column_stack(drawing.crosses.get_data()) / common.unit[0]
    return found[np.lexsort(found.T[::-1])]


def test_a_square_hole_is_crossed_from_its_edit_on_where_it_is_then(recorded):
    events = list(recorded.table["event"])
    made, held, gone = events.index("hole"), events.index("release"), events.index("delete")
    assert not len(crossed(recorded, 0)) and not len(crossed(recorded, gone))
    np.testing.assert_allclose(crossed(recorded, made), CORNERS, atol=1e-12)
    moved = recorded.points(held)
    there = crossed(recorded, held)
    assert len(there) == 4 and (there[:, 0] > CORNERS[:, 0] + 0.05).all()
    assert all(np.abs(moved - corner).max(axis=1).min() < 1e-12 for corner in there)
    common = scenery(recorded)
    words = [caption(recorded, i, common, 200) for i in (0, made, held, gone)]
    assert ["× singular places: peak" in one for one in words] == [False, True, True, False]


@pytest.mark.slow
def test_the_caption_says_how_many_places_have_no_cross(command, tmp_path):
    """Of forty re-entrant corners of a cut-out, which are more than a row of the table holds."""
    x = 0.2 + 1.6 * np.arange(40) / 39
    teeth = [[*map(float, one)] for one in zip(x, 0.4 - 0.1 * (np.arange(40) % 2))]
    polygon = [*teeth, *([a, 1.0 - b] for a, b in teeth[::-1])]
    text = HEAD + block(2.0, 1.0) + STEEL + HELD + PULLED + ASKED
    scene, script = (
        write_scene(tmp_path, text),
        write_script(tmp_path, [{"do": "hole", "name": "saw", "polygon": polygon}]),
    )
    assert command("replay", scene, "--edits", script, "--out", "a.vtkhdf").returncode == 0
    with Recording(tmp_path / "a.vtkhdf") as recording:
        known = decode_places(str(recording.table["singular_places"][1]))
        assert len(known.points) + known.more_points >= 40 > len(known.points)
        # The worst corners are crossed.
        assert len(crossed(recording, 1)) == len(known.points)
        words = caption(recording, 1, scenery(recording), 200)
    marked = f"({len(known.points)} of {len(known.points) + known.more_points} are crossed)"
    assert f"× singular places: peak {marked}" in words


def test_panels_and_tables_name_the_frames_and_the_worst_exponent(recorded, tmp_path, monkeypatch):
    """Williams's: a corner of 270 degrees has lambda = 0.544."""
    assert singular(recorded) == {"peak": pytest.approx(0.544484, abs=1e-6)}
    drawn = []
    monkeypatch.setattr(quantity_panels, "save_picture", lambda figure, path: drawn.append(figure))
    quantity_panels.draw_quantities(recorded, tmp_path / "a.png")
    titles = [axes.get_title(loc="left") for axes in drawn[0].findobj(Axes)]
    assert titles == [f"peak ({MARK}, in frames 1-{recorded.n - 2})", "stretch"]


def test_what_does_not_fit_is_left_out_and_other_texts_are_none():
    points = [[k + 0.123456, k + 0.654321] for k in range(40)]
    text = encode_places({"peak": 0.5, "tip": 0.0}, points)
    found = decode_places(text)
    assert len(text) <= PLACES_BYTES and found.exponents == {"peak": 0.5, "tip": 0.0}
    assert 10 < len(found.points) < 40
    np.testing.assert_allclose(found.points, points[: len(found.points)], rtol=1e-5)
    assert found.more_points == 40 - len(found.points) and found.more_quantities == 0
    many = decode_places(encode_places({f"q{'é' * 20}{k}": 0.5 for k in range(40)}, points))
    assert 0 < len(many.exponents) < 40 and not len(many.points)
    assert many.more_points == 40 and many.more_quantities == 40 - len(many.exponents)
    assert encode_places({"peak": 0.5}, points[:1]) == '[{"peak":0.5},[[0.123456,0.654321]]]'
    for other in ("", "[", "7", "[1,2]", '[{"a":null},[]]', "[{},[[1]]]", "[{},[[NaN,1]]]"):
        assert not len(decode_places(other).points) and not decode_places(other).exponents
