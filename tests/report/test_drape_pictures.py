"""Pictures of cloth show what is where: areas and outlines in them are those of the shapes."""

import json
import sys
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from restshape.cli.main import main
from restshape.replay.recorder import Recorder
from restshape.replay.recording import Recording
from restshape.report.body_surfaces import body_surface
from restshape.report.drape import BODY, Picture, drape_scenery, places, shows_cloth
from restshape.report.drape_frames import draw_drape_frames, rest_words, seen_window
from restshape.report.raster import Camera, hits
from restshape.report.space_axes import marks
from restshape.report.tables import level_table
from restshape.report.timeline import draw_timeline
from restshape.scene.bodies import Body

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "replay"))
from cloths_recorded import grid, record_cloth
from plates import record_plate

LOW, HIGH = np.full(3, -2.0), np.full(3, 2.0)
ABOVE = Camera(np.zeros(3), np.eye(3))
UNIT = (0.0, 1.0, 0.0, 1.0)


@pytest.fixture
def recording(tmp_path):
    """Opens recordings of cloth at heights, closed after the test."""
    opened = []

    def record(*heights: float, **words) -> Recording:
        record_cloth(tmp_path / "cloth.vtkhdf", heights, **words)
        opened.append(Recording(tmp_path / "cloth.vtkhdf"))
        return opened[-1]

    yield record
    for each in opened:
        each.close()


@pytest.mark.parametrize("distance", [np.inf, 3.0, 1.5])
def test_a_ball_is_seen_as_large_as_its_cone_of_sight(distance):
    places, triangles = body_surface(Body.model_validate({"sphere": {"center": [0, 0, 0], "radius": 1}}), LOW, HIGH)
    camera = Camera.towards(np.zeros(3), 0.7, 0.4, distance)
    seen = 1.0 if np.isinf(distance) else distance / np.sqrt(distance**2 - 1.0)
    window = (-2.0, 2.0, -2.0, 2.0)
    found = hits(camera, places, triangles, window, 400)
    assert found.there.mean() * 16.0 == pytest.approx(np.pi * seen**2, rel=0.01)


def test_of_two_squares_that_cross_the_nearer_one_is_seen():
    """One is flat at 0, the other rises along x through 0.25: they meet where x = 0.25."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    flat, rising = np.zeros(4), square[:, 0] - 0.25
    places = np.vstack([np.column_stack([square, flat]), np.column_stack([square, rising])])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    found = hits(ABOVE, places, triangles, UNIT, 200)
    x = (np.arange(200) + 0.5) / 200
    assert found.there.all()
    assert np.array_equal(found.triangle >= 2, np.broadcast_to(x > 0.25, (200, 200)))
    assert found.near == pytest.approx(np.broadcast_to(np.maximum(0.0, x - 0.25), (200, 200)), abs=1e-12)
    seen = np.einsum("rck,rckd->rcd", found.weights, places[triangles][found.triangle])
    assert seen[..., 0] == pytest.approx(np.broadcast_to(x, (200, 200)), abs=1e-12)


def test_what_lies_behind_the_camera_is_not_seen():
    camera = Camera.towards(np.zeros(3), 0.0, 0.0, 1.0)
    square = np.array([[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]])
    for x, there in ((-0.5, True), (1.5, False), (1.0, False)):
        found = hits(camera, square + np.array([x, 0.0, 0.0]), np.array([[0, 1, 2]]), (-1.0, 1.0, -1.0, 1.0), 50)
        assert found.there.any() == there


BODIES = {
    "sphere": ({"sphere": {"center": [0.1, 0.2, 0.3], "radius": 0.5}}, 4 / 3 * np.pi * 0.125),
    "capsule": (
        {"capsule": {"start": [-0.3, 0, 0.1], "end": [0.3, 0.8, 0.1], "radius": 0.25}},
        np.pi * 0.0625 * 1.0 + 4 / 3 * np.pi * 0.25**3,
    ),
    "box": ({"box": {"center": [0, 0.1, 0], "half": [0.5, 0.3, 0.2], "rotate": [0.3, 0.5, 1.1]}}, 8 * 0.03),
    "round box": (
        {"box": {"center": [0, 0.1, 0], "half": [0.5, 0.3, 0.2], "rotate": [0.3, 0.5, 1.1], "radius": 0.1}},
        # Steiner's formula for the core of half sizes 0.4, 0.2, 0.1.
        8 * 0.008 + 0.1 * 8 * (0.08 + 0.04 + 0.02) + np.pi * 0.01 * 2 * 0.7 + 4 / 3 * np.pi * 0.001,
    ),
}


@pytest.mark.parametrize("name", BODIES)
def test_surfaces_of_bodies_enclose_their_volume(name):
    given, volume = BODIES[name]
    places, triangles = body_surface(Body.model_validate(given), LOW, HIGH)
    a, b, c = (places[triangles[:, k]] for k in range(3))
    assert (np.cross(a, b) * c).sum() / 6.0 == pytest.approx(volume, rel=0.01)


def test_a_plane_is_shown_within_the_box():
    for normal, area in (((0, 0, 1), 16.0), ((0, 1, 1), 16.0 * np.sqrt(2)), ((1, 1, 1), 12 * np.sqrt(3))):
        places, triangles = body_surface(
            Body.model_validate({"plane": {"point": [0, 0, 0], "normal": normal}}), LOW, HIGH
        )
        a, b, c = (places[triangles[:, k]] for k in range(3))
        faces = 0.5 * np.cross(b - a, c - a)
        # The last one is the regular hexagon of side 2 sqrt(2) that cuts a cube of side 4 in two.
        assert np.linalg.norm(faces.sum(axis=0)) == pytest.approx(area)
        assert (faces @ normal > 0).all()
    away = Body.model_validate({"plane": {"point": [0, 0, 9], "normal": [0, 0, 1]}})
    assert len(body_surface(away, LOW, HIGH)[1]) == 0


def test_a_body_beyond_the_box_is_cut():
    long = Body.model_validate({"capsule": {"start": [0, -9, 0], "end": [0, 9, 0], "radius": 0.5}})
    places, triangles = body_surface(long, LOW, HIGH)
    window = (-4.0, 4.0, -4.0, 4.0)
    assert hits(ABOVE, places, triangles, window, 800).there.mean() * 64 == pytest.approx(8.0, rel=0.02)
    assert hits(ABOVE, places, triangles, window, 800, (LOW, HIGH)).there.mean() * 64 == pytest.approx(4.0, rel=0.02)


def test_cloth_from_above_covers_its_area_and_hides_the_ball(recording):
    cloth = recording(0.0)
    scenery = drape_scenery(cloth, np.arange(1))
    picture = Picture(scenery, scenery.from_above, (-0.5, 1.5, -0.5, 1.5), 200)
    pixels = picture.pixels(cloth, 0)
    assert pixels.shape == (200, 200, 4)
    assert pixels[..., 3].sum() / 10_000 == pytest.approx(1.0, abs=0.01)
    assert (pixels[60:140, 60:140, 3] == 1.0).all()
    # Nothing but dashes at 0.3 m from its centre tells of the ball.
    away = np.hypot(*(np.indices((200, 200)) + 0.5 - 100)) / 100
    others = (np.abs(away - 0.3) > 0.02) & (away < 0.45)
    assert np.ptp(pixels[others], axis=0).max() < 1e-12
    assert np.ptp(pixels[np.abs(away - 0.295) < 0.01], axis=0).max() > 0.1


def test_a_ball_above_the_cloth_is_translucent(recording):
    cloth = recording(-0.85)
    scenery = drape_scenery(cloth, np.arange(1))
    pixels = Picture(scenery, scenery.from_above, (0.0, 1.0, 0.0, 1.0), 200).pixels(cloth, 0)
    away = np.hypot(*(np.indices((200, 200)) + 0.5 - 100)) / 200
    plain = pixels[10, 10]
    changed = np.abs(pixels - plain).max(axis=2) > 0.05
    assert changed[away < 0.29].all() and not changed[(away > 0.31) & (away < 0.45)].any()
    # What shines through is the darkest blue of the map: less of it, and less of the ball.
    assert (pixels[away < 0.25, 2] < BODY[2]).all() and (pixels[..., 3] == 1.0).all()


def test_the_ball_is_where_the_frame_has_it(recording):
    cloth = recording(-0.85, -0.85, -0.85)
    scenery = drape_scenery(cloth, np.arange(3))
    camera, window = scenery.from_above, (0.0, 1.2, 0.0, 1.0)
    first, last = (Picture(scenery, camera, window, 240).pixels(cloth, i)[100, :200, :3] for i in (0, 2))
    # It has gone by 0.2 m, 40 pixels, from 0.2 m on.
    edges = [np.flatnonzero(np.abs(row - row[10]).max(axis=1) > 0.05)[0] for row in (first, last)]
    assert edges == pytest.approx([40, 80], abs=1)


def test_everything_at_rest_lies_within_the_box(recording):
    cloth = recording(0.0, -0.4, -900.0, rests=(1, 1, 0))
    scenery = drape_scenery(cloth, np.arange(3))
    for i in (0, 1):
        x = places(cloth, i)
        assert (scenery.low < x).all() and (x < scenery.high).all()
    # The ball goes from 0.5 to 0.7 along x and hangs down to -0.8.
    assert scenery.low[2] < -0.8 < -0.79 > scenery.low[2] and scenery.low[2] > -1.0
    left, right, bottom, top = seen_window(scenery)
    for corner in product(*zip(scenery.low, scenery.high)):
        (u, v), _ = (part[0] for part in scenery.from_aside.project(np.array([corner])))
        assert left - 1e-12 <= u <= right + 1e-12 and bottom - 1e-12 <= v <= top + 1e-12


def test_captions_tell_of_rest(recording):
    cloth = recording(0.0, 0.0, 0.0, rests=(1, 0, 1))
    cloth.table["tangent_positive_definite"][2] = 0
    assert rest_words(cloth, 0) == ("at rest and stable, residual 5e-05", True)
    assert rest_words(cloth, 1) == ("NOT AT REST, residual 5e-05", False)
    assert rest_words(cloth, 2) == ("at rest, but not stable, residual 5e-05", False)


def test_the_command_draws_cloth_in_space(recording, tmp_path, capsys):
    cloth = recording(0.0, -0.1, -0.2, rests=(1, 1, 0))
    out, data = tmp_path / "out", tmp_path / "report.json"
    assert main(["report", str(cloth.path), "--out", str(out), "--json", str(data)]) == 0
    assert "converged: 2 frames, 2 of them stable; not converged: 1" in capsys.readouterr().out
    found = json.loads(data.read_text())
    assert found["rest"] == {"converged": 2, "tangent_positive_definite": 2, "not_converged": 1}
    # No levels: only the ball has moved.
    assert [Path(p).name for p in found["pictures"]] == ["frames.png", "timeline.png", "animation.gif"]
    with Image.open(out / "animation.gif") as image:
        assert image.n_frames == 3
    assert main(["report", str(cloth.path), "--scale", "2"]) == 2
    assert "not exaggerated" in capsys.readouterr().err


def test_moved_bodies_count_as_values(recording):
    rows = {row["level"]: row["frames"] for row in level_table(recording(0.0, 0.0, 0.0))}
    assert rows["values"] == 2 and rows["idle"] == 0


def test_the_timeline_marks_frames_that_are_not_converged(recording, tmp_path, monkeypatch):
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path: figures.append(figure))
    draw_timeline(recording(0.0, 0.0, 0.0, rests=(1, 0, 0)), tmp_path / "a.png")
    band = figures[0].axes[1].patches[0]
    assert (band.get_x(), band.get_width()) == (0.5, 2.0)
    assert "not at rest (2)" in [text.get_text() for text in figures[0].legends[0].get_texts()]


def test_plates_and_solids_are_no_cloth(tmp_path):
    record_plate(tmp_path / "plate.vtkhdf", frames=2)
    with Recording(tmp_path / "plate.vtkhdf") as plate:
        assert not shows_cloth(plate)
    X, cells = grid(2)
    with Recorder.start(tmp_path / "plate.vtkhdf", {}, {}) as recorder:
        recorder.topology(cells)
        # A plate's modes are in space, too, but it has no tension.
        recorder.frame(0.0, X, {"displacement": np.zeros((len(X), 3))}, {}, {})
    with Recording(tmp_path / "plate.vtkhdf") as plate:
        assert not shows_cloth(plate)


def test_the_picture_of_single_frames(recording, tmp_path, capsys):
    from restshape_apps.couture.picture import main as picture

    cloth, path = recording(0.0, -0.1), tmp_path / "a.png"
    assert picture([str(cloth.path), "--frames", "0", "-1", "--out", str(path)]) == 0
    with Image.open(path) as image:
        assert len(np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0)) > 500
    assert picture([str(cloth.path), "--frames", "2", "--out", str(path)]) == 2
    assert picture([str(cloth.path), "--out", str(tmp_path / "none" / "a.png")]) == 2
    record_plate(tmp_path / "plate.vtkhdf", frames=2)
    assert picture([str(tmp_path / "plate.vtkhdf"), "--out", str(path)]) == 2
    printed = capsys.readouterr().err
    for message in ("there is no frame 2", "not of cloth", "cannot be written"):
        assert message in printed


def test_sides_have_two_numbers_or_more():
    # Round numbers within a metre and a half, and within 0.2 m that hold one hundredfold number alone.
    for low, high, factor, most in (
        (-0.72, 0.05, 1e3, 2),
        (0.03, 0.385, 1e3, 2),
        (-0.02, 0.11, 1.0, 2),
        (0.0, 1.5, 1.0, 4),
    ):
        places = marks(low, high, factor, most)
        assert 2 <= len(places) <= 5 and low <= places.min() and places.max() <= high
        steps = np.diff(places) * factor
        assert np.ptp(steps) < 1e-9 * steps[0]
        assert round(steps[0] / 10 ** np.floor(np.log10(steps[0]) + 1e-9), 6) in (1, 2, 5)


def test_a_sheet_holds_its_labels_and_each_frame_its_own_pattern(tmp_path, monkeypatch):
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path: figures.append(figure))
    X, cells = grid()
    path = tmp_path / "cloth.vtkhdf"
    with Recorder.start(path, {"title": "square", "app": "couture"}, {}) as recorder:
        recorder.topology(cells)
        for wide in (1.0, 0.25):
            # Negative numbers of four characters on all sides.
            place = np.column_stack([np.full((len(X), 2), -0.5), np.sin(3.0 * X[:, 0]) - 0.5])
            fields = {"displacement": place}
            recorder.frame(0.0, X * [wide, 0.5], fields, {"tension": np.ones(len(cells))}, {})
    with Recording(path) as cloth:
        draw_drape_frames(cloth, np.arange(2), drape_scenery(cloth, np.arange(2)), tmp_path / "a.png")
    (figure,) = figures
    renderer, whole = FigureCanvasAgg(figure).get_renderer(), figure.bbox
    figure.draw(renderer)
    sizes = [axes.get_xlabel().split("\n")[1] for axes in figure.axes if axes.get_xlabel().startswith("flat")]
    assert sizes == ["1 × 0.5 m", "0.25 × 0.5 m"]
    for axes in figure.axes[:6]:
        for label in (axes.xaxis.label, axes.yaxis.label, *axes.texts):
            box = label.get_window_extent(renderer)
            assert not label.get_text() or (whole.x0 <= box.x0 and box.x1 <= whole.x1), label.get_text()
    for axes in (figure.axes[0], figure.axes[3]):
        boxes = [text.get_window_extent(renderer) for text in axes.texts]
        assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])
