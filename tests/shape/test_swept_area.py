"""Areas of outlines against closed forms: arcs of any angle, far from the origin, and loops in loops."""

from fractions import Fraction
from math import factorial

import numpy as np
import pytest
from shape_scenes import square

from restshape.mesh.entity_area import entity_area, signed_loops
from restshape.mesh.generate import generate
from restshape.mesh.quality import areas
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.curves import segment_areas
from restshape.shape.outline import Outline

ANGLES = np.array([1e-9, 1e-5, 1e-3, 0.05, 0.19, 0.21, 1.0, np.pi, 4.0, 6.0])


def sine(x: Fraction) -> Fraction:
    """The sine by 40 terms of its series."""
    return sum(((-1) ** k * x ** (2 * k + 1) / factorial(2 * k + 1) for k in range(40)), Fraction())


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_segment_of_a_circle(sign):
    # With chord 1 the radius is 1 / (2 sin(angle / 2)); sines by their series in whole fractions, so that none cancel.
    exact = [float((a - sine(a)) / (8 * sine(a / 2) ** 2)) for a in map(Fraction, ANGLES)]
    found = segment_areas(sign * np.tan(ANGLES / 4.0))
    np.testing.assert_allclose(found, sign * np.array(exact), rtol=1e-12)
    assert segment_areas(np.zeros(1))[0] == 0.0


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_a_square_with_one_side_bent_to_a_half_circle(shift):
    outline = square()
    bulges = np.zeros(len(outline.edges))
    bulges[0] = 1.0
    side = outline.length(0)
    bent = outline.moved(outline.points + shift, bulges)
    assert bent.area() - outline.area() == pytest.approx(np.pi * side**2 / 8.0, rel=1e-12 if not shift else 1e-8)


def nested() -> Outline:
    """A square of side 4 with a round region of radius 1.5, in it a region of 1 x 1 and a hole of radius 0.2.

    A second hole, of radius 0.1, is outside all regions, a third of radius 0.15 in the inner region.
    """
    corners = {"a": [0, 0], "b": [4, 0], "c": [4, 4], "d": [0, 4], "e": [1.5, 2], "f": [2.5, 2], "g": [2.5, 3]}
    lines = {"ab": "ab", "bc": "bc", "cd": "cd", "da": "da", "ef": "ef", "fg": "fg", "gh": "gh", "he": "he"}
    return outline_from_spec(
        ShapeSpec(
            vertices={name: [float(x) for x in p] for name, p in (corners | {"h": [1.5, 3]}).items()},
            edges={name: {"line": list(ends)} for name, ends in lines.items()},
            outline=["ab", "bc", "cd", "da"],
            holes={
                "low": {"circle": {"center": [2.0, 1.2], "radius": 0.2}},
                "far": {"circle": {"center": [3.8, 3.8], "radius": 0.1}},
                "core": {"circle": {"center": [2.0, 2.5], "radius": 0.15}},
            },
            regions={
                "round": {"circle": {"center": [2.0, 2.0], "radius": 1.5}},
                "box": {"loop": ["ef", "fg", "gh", "he"]},
            },
        )
    )


def layered() -> Outline:
    """A bar of 4 by 2 with a region of its lower quarter, and in it one of its left half: all share the lowest side."""
    corners = {"a": [0, 0], "m": [2, 0], "b": [4, 0], "r": [4, 0.5], "c": [4, 2], "d": [0, 2], "l": [0, 0.5]}
    lines = {name: list(name) for name in ("am", "mb", "br", "rc", "cd", "dl", "la", "rn", "nl", "mn")}
    return outline_from_spec(
        ShapeSpec(
            vertices={name: [float(x) for x in p] for name, p in (corners | {"n": [2, 0.5]}).items()},
            edges={name: {"line": ends} for name, ends in lines.items()},
            outline=["am", "mb", "br", "rc", "cd", "dl", "la"],
            regions={"low": {"loop": ["am", "mb", "br", "rn", "nl", "la"]}, "left": {"loop": ["am", "mn", "nl", "la"]}},
        )
    )


def test_regions_that_share_sides_with_the_outline_and_each_other():
    outline = layered()
    assert {name: entity_area(outline, name) for name in ("all", "low", "left")} == pytest.approx(
        {"all": 8.0, "low": 1.0, "left": 1.0}, rel=1e-13
    )


def test_regions_are_less_what_lies_in_them():
    outline = nested()
    exact = {
        None: 16.0 - np.pi * (0.2**2 + 0.1**2 + 0.15**2),
        "outline": 16.0 - np.pi * (0.2**2 + 0.1**2 + 0.15**2),
        "round": np.pi * (1.5**2 - 0.2**2) - 1.0,
        "box": 1.0 - np.pi * 0.15**2,
    }
    for name, area in exact.items():
        assert entity_area(outline, name) == pytest.approx(area, rel=1e-13), name
    assert signed_loops(outline, "ab") == () and entity_area(outline, "ab") == 0.0


def test_cells_of_a_fine_mesh_fill_the_same():
    outline = nested()
    mesh = generate(outline, MeshSpec(size=0.1, edges_per_circle=90))
    for name in ("round", "box", "all"):
        cells = mesh.cells[mesh.cells_of(name)]
        assert areas(mesh.X, cells).sum() == pytest.approx(entity_area(outline, name), rel=2e-3), name
