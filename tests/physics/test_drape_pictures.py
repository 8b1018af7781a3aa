"""Pictures of cloth show what is where: areas and outlines in them are those of the shapes."""

import json
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from cloths_recorded import grid, record_cloth
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image
from plates import record_plate

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.physics.cloth.pictures.body_surfaces import body_surface
from restshape.physics.cloth.pictures.drape import bodies, drape_scenery, places, shows_cloth
from restshape.physics.cloth.pictures.drape_frames import _caption, convergence_words, draw_drape_frames
from restshape.physics.cloth.pictures.drape_image import BODY, DrapeImage
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.report import space_scene
from restshape.report.camera import Camera
from restshape.report.space_axes import marks
from restshape.report.space_scene import SpaceDrawing, SpaceImage
from restshape.report.style import INK, REFUSED, UNTRUSTED, new_figure
from restshape.report.tables import convergence_counts, level_table
from restshape.report.timeline import draw_timeline
from restshape.scene.bodies import Body

LOW, HIGH = np.full(3, -2.0), np.full(3, 2.0)
ABOVE = Camera.above()
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


def covered(camera, places, triangles, window, pixels, within=None) -> float:
    """The area that a surface covers in a picture [m2]."""
    scene = SpaceDrawing()
    scene.surface(places, triangles, "black", within=within)
    left, right, bottom, top = window
    return (1.0 - scene.pixels(camera, window, pixels, pixels).mean()) * (right - left) * (top - bottom)


def drawn(cloth, camera, window, columns, rows, i=0) -> np.ndarray:
    """The pixels of a frame of cloth."""
    image = DrapeImage(new_figure(2.0, 2.0).subplots(), camera, drape_scenery(cloth, np.arange(cloth.n)))
    image.show(cloth, i)
    return image.pixels(window, columns, rows)


@pytest.mark.parametrize("distance", [np.inf, 3.0, 1.5])
def test_a_ball_is_seen_as_large_as_its_cone_of_sight(distance):
    places, triangles = body_surface(Body.model_validate({"sphere": {"center": [0, 0, 0], "radius": 1}}), LOW, HIGH)
    camera = Camera.towards(np.zeros(3), 0.7, 0.4, distance)
    seen = 1.0 if np.isinf(distance) else distance / np.sqrt(distance**2 - 1.0)
    assert covered(camera, places, triangles, (-2.0, 2.0, -2.0, 2.0), 400) == pytest.approx(np.pi * seen**2, rel=0.01)


def test_a_ball_high_above_is_seen_from_above():
    sphere = {"sphere": {"center": [0, 0, 5], "radius": 1}}
    places, triangles = body_surface(Body.model_validate(sphere), LOW, HIGH + 5.0)
    assert covered(ABOVE, places, triangles, (-2.0, 2.0, -2.0, 2.0), 400) == pytest.approx(np.pi, rel=0.01)


def test_places_are_seen_where_the_camera_projects_them():
    camera = Camera.towards(np.array([0.3, -0.2, 0.1]), -1.1, 0.4, 2.5)
    window = (-0.7, 1.3, -0.6, 0.9)
    for place in np.random.default_rng(1).uniform(-0.3, 0.5, (8, 3)):
        scene = SpaceDrawing()
        dot = 0.02 * (camera.axes[[0, 1, 0, 1]] * [[-1.0], [-1.0], [1.0], [1.0]])
        scene.surface(place + dot, np.array([[0, 1, 2, 3]]), "black")
        dark = 1.0 - scene.pixels(camera, window, 400, 300)[..., 0]
        row, column = (np.average(np.indices(dark.shape)[k] + 0.5, weights=dark) for k in (0, 1))
        x, y = camera.project(place[None])[0]
        assert (column, row) == pytest.approx((200.0 * (x + 0.7), 200.0 * (y + 0.6)), abs=0.3)


def test_of_two_squares_that_cross_the_nearer_one_is_seen():
    """One is flat at 0, the other rises along x through 0.25: they meet where x = 0.25."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    scene, faces = SpaceDrawing(), np.array([[0, 1, 2, 3]])
    scene.surface(np.column_stack([square, np.zeros(4)]), faces, "#ff0000")
    scene.surface(np.column_stack([square, square[:, 0] - 0.25]), faces, "#0000ff")
    pixels = scene.pixels(ABOVE, UNIT, 200, 200)
    assert (pixels[:, :49, 0] > 0.4).all() and (pixels[:, :49, 2] == 0.0).all()
    assert (pixels[:, 51:, 2] > 0.4).all() and (pixels[:, 51:, 0] == 0.0).all()


def test_what_lies_on_top_is_seen_through_what_is_nearer_and_a_veil_is_translucent():
    square = np.array([[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 1.0, 0.5], [0.0, 1.0, 0.5]])
    image = SpaceImage(new_figure(2.0, 2.0).subplots(), ABOVE, opacity=0.4)
    image.scene.tubes(np.array([[[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]]]), "#00ff00", 0.1)
    image.scene.lines(np.array([[[0.0, 0.2, 0.0], [1.0, 0.2, 0.0]]]), "#ff0000", 4.0)
    image.scene.surface(square, np.array([[0, 1, 2, 3]]), "#808080")
    image.veil.surface(square + np.array([0.5, 0.0, 0.1]), np.array([[0, 1, 2, 3]]), "black")
    pixels = image.pixels(UNIT, 100, 100)
    assert (pixels[45:55, 2:98] == [0.0, 1.0, 0.0]).all()
    plain = pixels[20, 20]
    assert plain[0] == plain[2] and (pixels[15:25, 2:48] == plain).all()
    assert pixels[20, 80] == pytest.approx((1.0 - image.opacity) * plain, abs=1e-6)
    assert np.array_equal(pixels, image.pixels(UNIT, 100, 100))


def test_an_arrow_points_from_its_start_to_its_end():
    scene = SpaceDrawing()
    scene.arrow(np.array([0.2, 0.5, 0.0]), np.array([0.9, 0.5, 0.0]), "#0000ff", 0.01)
    blue = scene.pixels(ABOVE, UNIT, 200, 200)[..., 0] < 0.5
    columns, high = np.flatnonzero(blue.any(axis=0)), blue.sum(axis=0)
    assert (columns[0], columns[-1]) == pytest.approx((40, 178), abs=2)
    # The head is three times as wide as the shaft, and ends in a point.
    assert high[100] == pytest.approx(4, abs=1) and high[160:].max() == pytest.approx(12, abs=2) and high[178] < 3


def test_without_a_driver_the_message_says_what_to_install(monkeypatch):
    def missing(name):
        raise OSError(name)

    space_scene._screen.cache_clear()
    monkeypatch.setattr(space_scene, "CDLL", missing)
    scene = SpaceDrawing()
    scene.lines(np.zeros((1, 2, 3)), "black", 1.0)
    with pytest.raises(UserError, match="libegl1"):
        scene.pixels(ABOVE, UNIT, 10, 10)


def test_what_lies_behind_the_camera_is_not_seen():
    camera = Camera.towards(np.zeros(3), 0.0, 0.0, 1.0)
    square = np.array([[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]])
    window, before = (-1.0, 1.0, -1.0, 1.0), np.array([[-9.0, 0.0, 0.0], [-9.0, 0.1, 0.0], [-9.0, 0.0, 0.1]])
    for x, there in ((-0.5, True), (1.5, False)):
        # Something else is there, too, so that not all is behind.
        places = np.vstack([square + np.array([x, 0.0, 0.0]), before])
        area = covered(camera, places, np.array([[0, 1, 2], [3, 4, 5]]), window, 50)
        assert (area > 0.1) == there


BODIES = {
    "sphere": ({"sphere": {"center": [0.1, 0.2, 0.3], "radius": 0.5}}, 4 / 3 * np.pi * 0.125),
    "capsule": (
        {"capsule": {"start": [-0.3, 0, 0.1], "end": [0.3, 0.8, 0.1], "radius": 0.25}},
        np.pi * 0.0625 * 1.0 + 4 / 3 * np.pi * 0.25**3,
    ),
    "cylinder": (
        {"cylinder": {"start": [-0.3, 0, 0.1], "end": [0.3, 0.8, 0.1], "radius": 0.25}},
        np.pi * 0.0625 * 1.0,
    ),
    "round cylinder": (
        {"cylinder": {"start": [-0.3, 0, 0.1], "end": [0.3, 0.8, 0.1], "radius": 0.5, "rounded": 0.1}},
        # Its middle, and both ends: the integral of pi (0.4 + sqrt(0.01 - s^2))^2 over s from 0 to 0.1.
        np.pi * 0.25 * 0.8 + 2 * np.pi * (0.16 * 0.1 + 0.8 * np.pi * 0.01 / 4 + 2e-3 / 3),
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
        plane = Body.model_validate({"plane": {"point": [0, 0, 0], "normal": normal}})
        x, y, z = normal
        camera = Camera.towards(np.zeros(3), np.arctan2(y, x), np.arctan2(z, np.hypot(x, y)))
        # The last one is the regular hexagon of side 2 sqrt(2) that cuts a cube of side 4 in two.
        found = covered(camera, *body_surface(plane, LOW, HIGH), (-4.0, 4.0, -4.0, 4.0), 400, (LOW, HIGH))
        assert found == pytest.approx(area, rel=0.01)
    away = Body.model_validate({"plane": {"point": [0, 0, 9], "normal": [0, 0, 1]}})
    assert covered(ABOVE, *body_surface(away, LOW, HIGH), (-4.0, 4.0, -4.0, 4.0), 100, (LOW, HIGH)) == 0.0


def test_a_body_beyond_the_box_is_cut():
    long = body_surface(
        Body.model_validate({"capsule": {"start": [0, -9, 0], "end": [0, 9, 0], "radius": 0.5}}), LOW, HIGH
    )
    window = (-4.0, 4.0, -4.0, 4.0)
    assert covered(ABOVE, *long, window, 400) == pytest.approx(8.0, rel=0.02)
    assert covered(ABOVE, *long, window, 400, (LOW, HIGH)) == pytest.approx(4.0, rel=0.02)


@pytest.mark.slow
def test_cloth_from_above_covers_its_area_and_hides_the_ball(recording):
    pixels = drawn(recording(0.0), ABOVE, (-0.5, 1.5, -0.5, 1.5), 200, 200)
    assert pixels.shape == (200, 200, 3)
    assert (pixels < 1.0).any(axis=2).mean() * 4.0 == pytest.approx(1.0, abs=0.03)
    # Nothing but dashes at 0.3 m from its centre shows the ball.
    away = np.hypot(*(np.indices((200, 200)) + 0.5 - 100)) / 100
    others = (np.abs(away - 0.3) > 0.02) & (away < 0.45)
    assert np.ptp(pixels[others], axis=0).max() < 0.01
    assert np.ptp(pixels[np.abs(away - 0.295) < 0.01], axis=0).max() > 0.1


@pytest.mark.slow
def test_a_ball_above_the_cloth_is_translucent(recording):
    pixels = drawn(recording(-0.85), ABOVE, UNIT, 200, 200)
    away = np.hypot(*(np.indices((200, 200)) + 0.5 - 100)) / 200
    plain = pixels[10, 10]
    changed = np.abs(pixels - plain).max(axis=2) > 0.05
    assert changed[away < 0.29].all() and not changed[(away > 0.31) & (away < 0.45)].any()
    # What shines through is the darkest blue of the map: less of it, and less of the ball.
    assert (pixels[away < 0.25, 2] < BODY[2]).all()


@pytest.mark.slow
def test_the_ball_is_where_the_frame_has_it(recording):
    cloth = recording(-0.85, -0.85, -0.85)
    first, last = (drawn(cloth, ABOVE, (0.0, 1.2, 0.0, 1.0), 240, 200, i)[100, :200] for i in (0, 2))
    # It has gone by 0.2 m, 40 pixels, from 0.2 m on.
    edges = [np.flatnonzero(np.abs(row - row[10]).max(axis=1) > 0.05)[0] for row in (first, last)]
    assert edges == pytest.approx([40, 80], abs=1)


def test_a_body_that_moves_is_in_the_box_wherever_it_goes_but_for_what_is_far(recording):
    cloth = recording(*12 * [0.1])
    # Its centre goes from 0.5 to 1.6, with a radius of 0.3, beside cloth that ends at 1.
    for frames, right in ((np.arange(1), 1.0), (np.arange(12), 1.9)):
        high = drape_scenery(cloth, frames).high[0]
        assert right <= high <= right + 0.1
    still = recording(0.1, 0.1)
    far = {name: values for name, values in still.table.items()} | {
        "bodies.ball.sphere.center.0": np.array([0.5, 90.0])
    }
    still.table = far
    assert drape_scenery(still, np.arange(2)).high[0] < 5.0


def test_everything_at_rest_lies_within_the_box(recording):
    cloth = recording(0.0, -0.4, -900.0, rests=(1, 1, 0))
    scenery = drape_scenery(cloth, np.arange(3))
    for i in (0, 1):
        x = places(cloth, i)
        assert (scenery.low < x).all() and (x < scenery.high).all()
    # The ball goes from 0.5 to 0.7 along x and hangs down to -0.8.
    assert scenery.low[2] < -0.8 < -0.79 > scenery.low[2] and scenery.low[2] > -1.0
    left, right, bottom, top = scenery.from_aside.window(scenery.low, scenery.high)
    for corner in product(*zip(scenery.low, scenery.high)):
        ((u, v),) = scenery.from_aside.project(np.array([corner]))
        assert left - 1e-12 <= u <= right + 1e-12 and bottom - 1e-12 <= v <= top + 1e-12


def test_no_line_of_a_caption_begins_with_a_unit(recording):
    cloth = recording(0.0)
    cloth.table["untrusted"] = np.array(["stretched by 5.71 % at (0, 592) mm of the pattern, trusted are 5 %"])
    for wide in np.linspace(1.0, 5.0, 41):
        text, colour = _caption(cloth, 0, wide)
        assert colour == UNTRUSTED and not any(line.strip()[:1] == "%" for line in text.splitlines())
        assert not any(line.strip().startswith("mm") for line in text.splitlines())


def test_captions_report_convergence(recording):
    cloth = recording(0.0, 0.0, 0.0, rests=(1, 0, 1))
    cloth.table["tangent_positive_definite"][2] = 0
    assert convergence_words(cloth, 0) == ("converged and stable, residual 5e-05", INK)
    assert convergence_words(cloth, 1) == ("NOT CONVERGED, residual 5e-05", REFUSED)
    assert convergence_words(cloth, 2) == ("converged, but not stable, residual 5e-05", REFUSED)


def test_frames_of_cloth_that_are_predicted_say_so_and_are_not_counted(recording):
    cloth = recording(0.0, 0.0, 0.0, rests=(1, -1, 0))
    cloth.table["predicted"], cloth.table["estimate"] = np.array([0, 1, 0]), np.array([0.01, 0.0123, np.nan])
    assert convergence_words(cloth, 1) == ("predicted, not solved, about 1.2 % off", INK)
    counts = convergence_counts(cloth)
    assert (counts["converged"], counts["not_converged"]) == (1, 1)


def test_no_caption_is_black_where_a_frame_is_not_to_be_trusted(recording):
    cloth = recording(0.0, 0.0, 0.0, rests=(1, 0, 1))
    cloth.table["untrusted"] = np.array(["an edge is stretched by 40 %", "bodies.ball comes through", ""])
    words, colour = convergence_words(cloth, 0)
    assert words.endswith("stable, residual 5e-05; NOT TRUSTED: an edge is stretched by 40 %") and colour == UNTRUSTED
    words, colour = convergence_words(cloth, 1)
    assert "NOT CONVERGED" in words and "bodies.ball comes through" in words and colour == REFUSED
    assert convergence_words(cloth, 2) == ("converged and stable, residual 5e-05", INK)


@pytest.mark.slow
def test_a_refused_frame_shows_the_bodies_of_the_last_one_and_the_reason(recording, tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    cloth = recording(0.0, -0.1, -0.1)
    cloth.table["refused"] = np.array(["", "", "the radius is given by a formula; write another formula"])
    for name, values in cloth.table.items():
        if name.startswith("bodies."):
            values[2] = np.nan
    (ball,) = bodies(cloth, 2).values()
    # The ball of frame 1, which is 0.1 m further along x than that of frame 0.
    assert ball.sphere.center == pytest.approx((0.6, 0.5, -0.5)) and ball.sphere.radius == 0.3
    words, colour = convergence_words(cloth, 2)
    assert colour == REFUSED and "REFUSED, last solution shown: the radius is given by a formula" in words
    draw_drape_frames(cloth, np.arange(3), drape_scenery(cloth, np.arange(3)), tmp_path / "a.png")
    figure = figures[0]
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    titles = [axes._left_title.get_window_extent(renderer) for axes in figure.axes if axes.get_title(loc="left")]
    assert len(titles) == 3 and not any(a.overlaps(b) for k, a in enumerate(titles) for b in titles[:k])
    assert max(box.y1 for box in titles) < figure._suptitle.get_window_extent(renderer).y0


@pytest.mark.slow
def test_the_title_of_a_single_frame_is_within_the_picture(recording, tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    cloth = recording(0.0)
    scenery = replace(drape_scenery(cloth, np.arange(1)), pins={0: np.arange(3)})
    draw_drape_frames(cloth, np.arange(1), scenery, tmp_path / "a.png")
    (figure,) = figures
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    title, width = figure._suptitle.get_window_extent(renderer), figure.get_size_inches()[0] * figure.dpi
    assert figure._suptitle.get_text().endswith("circles: supports") and title.x0 > 0 and title.x1 < width
    caption = next(axes._left_title for axes in figure.axes if axes.get_title(loc="left"))
    assert caption.get_window_extent(renderer).y1 < title.y0


@pytest.mark.slow
def test_the_words_of_the_colour_bar_are_within_the_picture(recording, tmp_path, monkeypatch):
    """Tensions below 0 have the longest numbers beside the bar: a sign and two decimals."""
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    cloth = recording(0.0)
    draw_drape_frames(cloth, np.arange(1), replace(drape_scenery(cloth, np.arange(1)), bottom=-0.3, top=1.9), tmp_path)
    (figure,) = figures
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    bar = next(axes for axes in figure.axes if "tension" in axes.get_ylabel())
    assert any(label.get_text() == "\N{MINUS SIGN}0.25" for label in bar.get_yticklabels())
    assert bar.get_tightbbox(canvas.get_renderer()).x1 <= canvas.get_width_height()[0]


@pytest.mark.slow
def test_the_command_draws_cloth_in_space(recording, tmp_path, capsys):
    cloth = recording(0.0, -0.1, -0.2, rests=(1, 1, 0))
    out, data = tmp_path / "out", tmp_path / "report.json"
    assert main(["report", str(cloth.path), "--out", str(out), "--json", str(data)]) == 0
    assert "converged: 2 frames, 2 of them stable; not converged: 1" in capsys.readouterr().out
    found = json.loads(data.read_text())
    assert found["rest"] == {"converged": 2, "tangent_positive_definite": 2, "untrusted": 0, "not_converged": 1}
    # No levels: only the ball has moved.
    assert [Path(p).name for p in found["pictures"]] == ["frames.png", "timeline.png", "animation.gif"]
    with Image.open(out / "animation.gif") as image:
        assert image.n_frames == 3
    assert main(["report", str(cloth.path), "--scale", "2"]) == 2
    assert "not exaggerated" in capsys.readouterr().err


def test_moved_bodies_count_as_values(recording):
    rows = {row["level"]: row["frames"] for row in level_table(recording(0.0, 0.0, 0.0))}
    assert rows["values"] == 2 and rows["idle"] == 0


@pytest.mark.slow
def test_the_timeline_marks_frames_that_are_not_converged(recording, tmp_path, monkeypatch):

    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    draw_timeline(recording(0.0, 0.0, 0.0, rests=(1, 0, 0)), tmp_path / "a.png")
    band = figures[0].axes[1].patches[0]
    assert (band.get_x(), band.get_width()) == (0.5, 2.0)
    assert "not converged (2)" in [text.get_text() for text in figures[0].legends[0].get_texts()]


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_sheet_holds_its_labels_and_each_frame_its_own_pattern(tmp_path, monkeypatch):

    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    X, cells = grid()
    path = tmp_path / "cloth.vtkhdf"
    with Recorder.start(path, {"title": "square", "app": "cloth"}, {}) as recorder:
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
