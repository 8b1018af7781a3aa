"""Drawings for a workshop: areas by ezdxf alone, paths at their distance, and what does not fit."""

from itertools import pairwise
from xml.etree import ElementTree

import curve_areas
import ezdxf
import numpy as np
import pytest
from edited_shapes import edited
from test_drawings_written import of_dxf, of_path

from restshape.errors import UserError
from restshape.export.cut_drawing import EngravedText, Engraving, cut_drawing
from restshape.export.cut_files import UNITS, write_cut_dxf, write_cut_svg
from restshape.export.kerf import tool_path
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.draft import Draft, DraftEdge, add_loop
from restshape.shape.nearness import distances
from restshape.shape.outline import Outline

KERF = 2e-3
CORD = Engraving(
    holes={"hang_1": (np.array([0.3, 0.85]), 4e-3)},
    crosses=np.array([[1.0, 0.9]]),
    texts=(EngravedText("C5", np.array([1.0, 0.7]), 0.02),),
)


@pytest.fixture(scope="module")
def outline(tmp_path_factory) -> Outline:
    return edited(tmp_path_factory.mktemp("shape")).outline


def polygon(*corners: tuple[float, float], holes: dict | None = None) -> Outline:
    """A shape of straight edges."""
    names = [f"v{i}" for i in range(len(corners))]
    edges = {f"e{i}": {"line": [name, names[(i + 1) % len(names)]]} for i, name in enumerate(names)}
    tables = {"vertices": dict(zip(names, corners)), "edges": edges, "outline": list(edges), "holes": holes or {}}
    return outline_from_spec(ShapeSpec.model_validate(tables))


def read_back(path, unit: str) -> dict[str, float]:
    """The area [m^2] of what lies on each layer of a drawing, by ezdxf alone."""
    drawing = ezdxf.readfile(path)
    assert drawing.header["$INSUNITS"] == {"mm": 4, "cm": 5, "m": 6, "in": 1}[unit]
    metres, border, holes = UNITS[unit][0], [], []
    for entity in drawing.modelspace().query('LINE ARC CIRCLE SPLINE LWPOLYLINE[layer!="ENGRAVE"]'):
        if entity.dxf.layer == "CUT":
            border += of_dxf(entity)
        else:
            assert entity.dxftype() == "CIRCLE"
            holes.append(of_dxf(entity))
    near = 1e-9 / metres
    found = {
        "CUT": curve_areas.enclosed(border, near),
        "HOLES": sum(curve_areas.enclosed(hole, near) for hole in holes),
    }
    return {layer: metres**2 * area for layer, area in found.items()}


def slotless(outline: Outline) -> Outline:
    """The same shape without its polygonal hole, so that all holes are circles."""
    from restshape.export.shape_tables import shape_tables

    tables = shape_tables(outline)
    tables["holes"] = {name: hole for name, hole in tables["holes"].items() if name != "slot"}
    return outline_from_spec(ShapeSpec.model_validate(tables))


@pytest.mark.parametrize(("kerf", "unit"), [(0.0, "mm"), (KERF, "mm"), (KERF, "in")])
def test_a_drawing_for_a_workshop_has_the_area_of_the_shape_with_its_holes(outline, tmp_path, kerf, unit):
    drawing = cut_drawing(slotless(outline), kerf, CORD)
    write_cut_dxf(drawing, tmp_path / "plate.dxf", unit)
    areas = read_back(tmp_path / "plate.dxf", unit)
    assert areas["CUT"] - areas["HOLES"] == pytest.approx(drawing.path.area(), rel=1e-9)
    if not kerf:
        assert areas["CUT"] - areas["HOLES"] == pytest.approx(slotless(outline).area() - np.pi * 4e-3**2, rel=1e-9)


def test_engraved_are_regions_points_crosses_and_texts(outline, tmp_path):
    write_cut_dxf(cut_drawing(outline, KERF, CORD), tmp_path / "plate.dxf")
    drawing = ezdxf.readfile(tmp_path / "plate.dxf")
    assert {entity.dxf.layer for entity in drawing.modelspace()} == {"CUT", "HOLES", "ENGRAVE"}
    engraved = drawing.modelspace().query('*[layer=="ENGRAVE"]')
    assert sorted(entity.dxftype() for entity in engraved) == ["ARC"] * 4 + ["LINE"] * 2 + ["POINT", "TEXT"]
    (text,) = engraved.query("TEXT")
    assert text.dxf.text == "C5" and text.dxf.height == 20.0
    np.testing.assert_allclose(tuple(text.get_placement()[1])[:2], (1000.0, 700.0))
    np.testing.assert_allclose(tuple(engraved.query("POINT")[0].dxf.location)[:2], (1000.0, 800.0))


def test_an_svg_for_a_workshop_has_one_path_a_loop(outline, tmp_path):
    drawing = cut_drawing(outline, KERF, CORD)
    write_cut_svg(drawing, tmp_path / "plate.svg")
    groups = {group.get("id"): group for group in ElementTree.parse(tmp_path / "plate.svg").getroot()}
    cut, holes = ([of_path(path.get("d").removesuffix(" Z")) for path in groups[layer]] for layer in ("CUT", "HOLES"))
    assert len(cut) == 1 and len(holes) == 4
    area = curve_areas.enclosed(cut[0], 1e-6) - sum(curve_areas.enclosed(hole, 1e-6) for hole in holes)
    assert 1e-6 * area == pytest.approx(drawing.path.area(), rel=1e-9)
    assert [one.text for one in groups["ENGRAVE"] if one.tag.endswith("text")] == ["C5"]


def test_the_path_of_a_tool_keeps_half_the_width_of_the_cut_from_the_shape_everywhere(outline):
    path = tool_path(outline, KERF)
    border = [e for loop in outline.loops if loop.kind != "region" for e, _ in loop.edges]
    chains = [outline.polyline(e, 1e-7) for e in border]
    starts, ends = (np.concatenate([chain[part] for chain in chains]) for part in (slice(-1), slice(1, None)))
    places = np.concatenate([path.point(e, np.linspace(0.0, 1.0, 40)) for e in range(len(path.edges))])
    # The shape's box is 2 m wide, and splines are within 1e-6 of that.
    np.testing.assert_allclose(distances(places, starts, ends), 0.5 * KERF, rtol=0.0, atol=2.1e-6)


def test_areas_of_paths_are_those_of_steiner():
    """A + d L + pi d^2 of a convex shape; of a corner that points in d^2 tan(turn / 2) less than without the turn."""
    hole = {"bore": {"circle": {"center": [0.05, 0.03], "radius": 0.01}}}
    square, d = polygon((0, 0), (0.1, 0), (0.1, 0.06), (0, 0.06), holes=hole), 0.5 * KERF
    expected = 0.006 + d * 0.32 + np.pi * d**2 - np.pi * (0.01 - d) ** 2
    assert tool_path(square, KERF).area() == pytest.approx(expected, rel=1e-13)
    angle = polygon((0, 0), (0.1, 0), (0.1, 0.02), (0.02, 0.02), (0.02, 0.06), (0, 0.06))
    turned = 5.0 * 0.25 * np.pi - 1.0
    assert tool_path(angle, KERF).area() == pytest.approx(0.0028 + d * 0.32 + d**2 * turned, rel=1e-13)


@pytest.mark.parametrize(
    ("shape", "kerf", "words"),
    [
        (polygon((0, 0), (1, 0), (1, 1), (0.51, 1), (0.5, 0.5), (0.49, 1), (0, 1)), 0.1, "wider than the corner"),
        (polygon((0, 0), (1, 0), (1, 1), (0.52, 1), (0.52, 0.5), (0.48, 0.5), (0.48, 1), (0, 1)), 0.05, "wider than"),
        (
            polygon((0, 0), (1, 0), (1, 1), (0, 1), holes={"eye": {"circle": {"center": [0.5, 0.5], "radius": 0.01}}}),
            0.03,
            "radius of 10 mm, within the cut",
        ),
    ],
)
def test_a_cut_that_is_wider_than_a_bay_or_a_hole_is_refused_with_its_place(shape, kerf, words):
    with pytest.raises(UserError, match=words) as error:
        tool_path(shape, kerf)
    assert error.value.where == "--kerf"


def test_a_spline_that_bends_more_than_a_cut_can_follow_is_refused():
    tables = {
        "vertices": {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]},
        "edges": {"low": {"line": ["a", "b"]}, "right": {"line": ["b", "c"]}, "left": {"line": ["d", "a"]}},
        "outline": ["low", "right", "top", "left"],
    }
    tables["edges"]["top"] = {"spline": ["c", "d"], "through": [[0.6, 0.95], [0.5, 0.5], [0.4, 0.95]]}
    shape = outline_from_spec(ShapeSpec.model_validate(tables))
    with pytest.raises(UserError, match="the edge top bends inwards with a radius of"):
        tool_path(shape, 0.2)


def test_a_hole_for_a_cord_that_reaches_the_edge_is_refused(outline):
    with pytest.raises(UserError, match="hang_1"):
        cut_drawing(outline, 0.0, Engraving(holes={"hang_1": (np.array([0.003, 0.5]), 4e-3)}))


def test_a_pattern_of_several_pieces_has_no_path_of_one_tool():
    corners = {"a": (0, 0), "b": (0.2, 0), "c": (0.2, 0.1), "d": (0, 0.1)}
    shifted = {f"{name}2": (x + 0.3, y) for name, (x, y) in corners.items()}
    draft = Draft(vertices=corners | shifted)
    for piece, names in (("front", "abcd"), ("back", ("a2", "b2", "c2", "d2"))):
        for start, end in pairwise([*names, names[0]]):
            draft.edges[f"{start}{end}"] = DraftEdge(f"{start}{end}", "line", start, end, "")
        add_loop(draft, piece, "outline", [f"{a}{b}" for a, b in pairwise([*names, names[0]])])
    panels = draft.outline()
    assert panels.piece_names == ("front", "back")
    with pytest.raises(UserError, match="several pieces"):
        tool_path(panels, KERF)
    assert cut_drawing(panels, 0.0, Engraving()).path is panels
