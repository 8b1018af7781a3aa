"""The picture of a scene before any solve: what acts where and which way, and every name once, none on another."""

import numpy as np
import pytest
from cloths import BALL, CONTACT, write_cloth
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.quiver import Quiver
from small_scenes import BLOCK, CLAMPED, HEAD, HOLE, STEEL, meshed, write_scene

from restshape.cli.check_scene import starting_outline
from restshape.cli.main import main
from restshape.report.conditions import LOADS as COLOURS
from restshape.report.conditions import SUPPORT
from restshape.report.entity_outlines import place_of
from restshape.report.name_labels import Labels
from restshape.scene.load import load_scene

LOADS = """
[loads.push]
on = "window"
pressure = "2 MPa"

[loads.weight]
on = "top"
force = [0, "-3 kN"]

[loads.corner]
on = "c"
force = ["1 N", 0]

[loads.own]
on = "all"
body = [0, "-5 kN/m^3"]
"""
SCENE = HEAD + BLOCK.format(width=2, height=1) + HOLE + STEEL + CLAMPED + LOADS + meshed(0.2)


@pytest.fixture
def figure(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    assert main(["check", str(write_scene(tmp_path, SCENE)), "--picture", str(tmp_path / "scene.png")]) == 0
    return figures[0]


def test_loads_act_where_and_as_the_scene_says(figure):
    (axes,) = figure.axes
    assert axes.get_xlabel() == "x [m]" and axes.get_ylabel() == "y [m]"
    arrows = [one for one in axes.get_children() if isinstance(one, Quiver)]
    found = {tuple(at.round(9)): (u, v, one.pivot) for one in arrows for at, u, v in zip(one.XY, one.U, one.V)}
    down = {at: way for at, way in found.items() if at[1] == 1.0 and at != (2.0, 1.0)}
    assert len(down) == 7 and all(u == 0 and v < 0 and pivot == "tip" for u, v, pivot in down.values())
    assert found[(2.0, 1.0)][0] > 0 and found[(2.0, 1.0)][1:] == (0.0, "tail")
    # A pressure in a hole pushes outwards from its middle.
    ring = {at: way for at, way in found.items() if abs(np.hypot(at[0] - 0.5, at[1] - 0.5) - 0.15) < 1e-6}
    assert len(ring) == 8
    for (x, y), (u, v, pivot) in ring.items():
        assert pivot == "tip" and u * (x - 0.5) + v * (y - 0.5) > 0.99 * 0.15 * np.hypot(u, v)
    inside = [way for at, way in found.items() if 0.05 < at[0] < 1.95 and at not in ring and at not in down]
    assert len(inside) == 1 and inside[0][0] == 0 and inside[0][1] < 0


def test_arrows_along_their_edge_are_one_and_values_of_parameters_are_written(tmp_path, monkeypatch):
    """A force along an edge shorter than its arrow is one arrow; along a longer one all do not overlap."""
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    loads = '[parameters]\nP = "-1000 N"\n[loads.shear]\non = "right"\nforce = [0, "P"]\n'
    loads += '[loads.along]\non = "top"\nforce = ["1 N", 0]\n'
    text = HEAD + BLOCK.format(width=2, height=0.2) + STEEL + CLAMPED + loads + meshed(0.2)
    assert main(["check", str(write_scene(tmp_path, text)), "--picture", str(tmp_path / "scene.png")]) == 0
    (axes,) = figures[0].axes
    shear, along = (one for one in axes.get_children() if isinstance(one, Quiver))
    assert len(shear.XY) == 1 and np.allclose(shear.XY, [2.0, 0.1])
    # Places are 2 m / 7 apart, and an arrow is 9 % of the width of 2.64 m long.
    assert len(along.XY) == 7 and np.allclose(np.diff(along.XY[:, 0]), -2.0 / 7.0) and along.U.max() < 2.0 / 7.0
    words = [text.get_text().replace("\n", " ") for text in figures[0].texts]
    assert "load shear on right: force (0, P = -1000) N" in words


@pytest.mark.parametrize("g", ['[0, "-9.81 m/s^2"]', '["3 m/s^2", "-G"]'])
def test_gravity_is_an_arrow_in_the_corner_and_in_the_legend(tmp_path, monkeypatch, g):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    own = f'[parameters]\nG = "4 m/s^2"\n[effects.gravity]\ng = {g}\n'
    text = HEAD + own + BLOCK.format(width=2, height=1) + STEEL + CLAMPED + meshed(0.2)
    assert main(["check", str(write_scene(tmp_path, text)), "--picture", str(tmp_path / "scene.png")]) == 0
    (axes,) = figures[0].axes
    (arrow,) = (one for one in axes.get_children() if isinstance(one, Quiver))
    way = (arrow.U[0], arrow.V[0])
    assert np.allclose(way / np.hypot(*way), [0.0, -1.0] if "9.81" in g else [0.6, -0.8])
    assert arrow.XY[0][0] < 0.0 and arrow.XY[0][1] > 1.0
    words = [text.get_text() for text in figures[0].texts]
    assert any(word.startswith("gravity: (") and word.endswith("m/s^2") for word in words), words


def test_gravity_across_the_plane_is_in_the_legend_alone(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    scene = write_cloth(tmp_path, BALL, CONTACT)
    assert main(["check", str(scene), "--picture", str(tmp_path / "scene.png")]) == 0
    assert not any(isinstance(one, Quiver) for one in figures[0].axes[0].get_children())
    words = [text.get_text() for text in figures[0].texts]
    colours = [line.get_color() for line in figures[0].get_children() if isinstance(line, Line2D)]
    assert words[1:] == ["gravity: (0, 0, -9.81) m/s^2"] and colours == ["white"]


def test_supports_and_legend(figure):
    (axes,) = figure.axes
    thick = [one for one in axes.collections if isinstance(one, LineCollection) and one.get_linewidth()[0] == 3.0]
    (line,) = thick[0].get_segments()
    assert np.allclose(line[:, 0], 0.0) and np.ptp(line[:, 1]) == 1.0
    words = [text.get_text().replace("\n", " ") for text in figure.texts]
    assert "load weight on top: force (0, -3) kN" in words and "load push on window: pressure 2 MPa" in words
    assert any(word.startswith("support") and "x = 0 and y = 0" in word for word in words)
    colours = [line.get_color() for line in figure.get_children() if isinstance(line, Line2D)]
    assert {*colours} <= {SUPPORT, *COLOURS}
    # Loads have a colour each, in the picture as in the legend.
    assert len({*colours}) == len(colours) == 5
    assert "2 × 1 m" in figure.get_suptitle() and "mesh size 0.2 m" in figure.get_suptitle()


@pytest.mark.slow
def test_every_name_is_written_once_and_none_on_another(figure):
    (axes,) = figure.axes
    names = [text.get_text() for text in axes.texts]
    assert sorted(names) == sorted(["a", "b", "c", "d", "bottom", "right", "top", "left", "window"])
    FigureCanvasAgg(figure).draw()
    boxes = [text.get_bbox_patch().get_window_extent() for text in axes.texts]
    for k, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[k + 1 :])
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1


def test_labels_keep_off_each_other_and_off_the_border():
    axes = Figure(figsize=(3, 3)).add_axes((0.1, 0.1, 0.8, 0.8))
    labels = Labels(axes)
    for _ in range(9):
        labels.add((0.98, 0.5), "a name", "k")
    FigureCanvasAgg(axes.figure).draw()
    boxes = [text.get_bbox_patch().get_window_extent() for text in axes.texts]
    assert not any(box.overlaps(other) for k, box in enumerate(boxes) for other in boxes[k + 1 :])
    assert max(box.x1 for box in boxes) <= axes.bbox.x1 + 8


def test_outwards_is_away_from_the_body(tmp_path):
    outline = starting_outline(load_scene(write_scene(tmp_path, SCENE)))
    for name, way in (("left", (-1, 0)), ("top", (0, 1)), ("right", (1, 0)), ("bottom", (0, -1))):
        np.testing.assert_allclose(place_of(outline, name).outwards, np.tile(way, (7, 1)), atol=1e-12)


@pytest.mark.slow
def test_a_picture_is_png_or_svg_and_no_foreign_file_is_replaced(tmp_path, capsys):
    scene = str(write_scene(tmp_path, SCENE))
    assert main(["check", scene, "--picture", str(tmp_path / "a.txt")]) == 2
    (tmp_path / "mine.svg").write_text("<svg/>")
    assert main(["check", scene, "--picture", str(tmp_path / "mine.svg")]) == 2
    assert (tmp_path / "mine.svg").read_text() == "<svg/>"
    for _ in range(2):
        assert main(["check", scene, "--picture", str(tmp_path / "own.svg")]) == 0
    assert (tmp_path / "own.svg").read_text().startswith("<?xml")
    assert "ends in .png or .svg" in capsys.readouterr().err


def test_names_keep_off_arrows_and_edges(figure):
    """No name of the picture lies on a load's arrow, by the boxes and lines that matplotlib draws."""
    (axes,) = figure.axes
    FigureCanvasAgg(figure).draw()
    to_pixels = axes.transData.transform
    arrows = []
    for one in axes.get_children():
        if isinstance(one, Quiver):
            way = np.column_stack([one.U, one.V])
            tails = one.XY - way if one.pivot == "tip" else one.XY
            arrows += [to_pixels(tail + np.linspace(0.0, 1.0, 50)[:, None] * by) for tail, by in zip(tails, way)]
    assert len(arrows) > 15
    covered = [
        text.get_text()
        for text in axes.texts
        for line in arrows
        if text.get_bbox_patch().get_window_extent().contains(*line[25]) or _inside(text, line)
    ]
    assert set(covered) <= {"window"}, covered


def _inside(text, line):
    box = text.get_bbox_patch().get_window_extent()
    return ((line > (box.x0, box.y0)) & (line < (box.x1, box.y1))).all(axis=1).any()


def test_a_name_goes_where_no_line_is():
    """First the way asked for; with a line there the next one."""
    places = []
    for lines in ([], [np.array([[0.5, 0.5], [0.9, 0.5]])]):
        axes = Figure(figsize=(3, 3)).add_axes((0.1, 0.1, 0.8, 0.8))
        labels = Labels(axes)
        labels.keep_off(lines, 2.0)
        labels.add((0.5, 0.5), "name", "k", first=np.array([1.0, 0.0]))
        places.append(np.array(axes.texts[0].xyann))
    assert places[0][0] > 10 and places[0][1] == 0 and abs(places[1][1]) > 5


def test_round_shapes_look_round_and_have_their_size(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    disc = '[shape]\noutline = ["a", "b"]\nvertices = { l = [-1, 0], r = [1, 0] }\n'
    disc += 'edges = { a = { arc = ["r", "l"], bulge = 1 }, b = { arc = ["l", "r"], bulge = 1 } }\n'
    scene = write_scene(tmp_path, HEAD + disc + STEEL + CLAMPED.replace("left", "a") + meshed(0.4))
    assert main(["check", str(scene), "--picture", str(tmp_path / "scene.png")]) == 0
    (axes,) = figures[0].axes
    (edges,) = [one for one in axes.collections if isinstance(one, LineCollection) and one.get_linewidth()[0] == 0.8]
    for line in edges.get_segments():
        middles = 0.5 * (line[1:] + line[:-1])
        assert np.hypot(*middles.T).min() > 0.9999
    assert "2 × 2 m" in figures[0].get_suptitle()


RING = """
[shape]
outline = ["a", "b", "c"]
vertices.p = [18, 0]
vertices.q = [-9, 15.588457268119896]
vertices.r = [-9, -15.588457268119896]
edges.a = { arc = ["p", "q"], bulge = 0.5773502691896257 }
edges.b = { arc = ["q", "r"], bulge = 0.5773502691896257 }
edges.c = { arc = ["r", "p"], bulge = 0.5773502691896257 }
holes.bore.circle = { center = [0, 0], radius = 5 }
regions.ring.circle = { center = [0, 0], radius = 10 }
"""


@pytest.mark.slow
def test_a_ring_has_its_name_in_its_material_its_hole_empty_and_its_own_width(tmp_path, monkeypatch):
    """A disc of 36 m with a ring of 5 m to 10 m: three arcs of 120 degrees, so that no vertex is at its top."""
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    names = ", ".join(f'"bore.{k}"' for k in (1, 2, 3, 4))
    loads = "".join(f"[loads.push{k}]\non = [{names}]\npressure = {k + 1}\n" for k in range(40))
    scene = write_scene(tmp_path, HEAD + RING + STEEL + CLAMPED.replace("left", "a") + loads + meshed(2))
    assert main(["check", str(scene), "--picture", str(tmp_path / "scene.png")]) == 0
    (axes,) = figures[0].axes
    (name,) = [text for text in axes.texts if text.get_text() == "ring"]
    FigureCanvasAgg(figures[0]).draw()
    box = name.get_window_extent().transformed(axes.transData.inverted())
    assert 5 < np.hypot(*np.mean(box.get_points(), axis=0)) < 10
    looks = {one.get_facecolor()[:3]: one for one in axes.patches}
    empty = looks[1.0, 1.0, 1.0]
    assert np.hypot(*empty.get_xy().T).max() == pytest.approx(5)
    assert empty.get_zorder() > max(one.get_zorder() for one in axes.patches if one is not empty)
    assert "36 × 36 m" in figures[0].get_suptitle()
    words = [text.get_text() for text in figures[0].texts if text.get_text().startswith(("support", "load", "and"))]
    assert len(words) == 17 and words[-1] == "and 25 more conditions"
