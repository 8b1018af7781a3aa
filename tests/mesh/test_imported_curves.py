"""Curved boundaries of mesh files: circles are recognised, and nodes in the middle of sides are kept."""

from pathlib import Path

import gmsh
import numpy as np
import pytest
from small_scenes import head

from restshape.cli.doubts import doubts
from restshape.interface.first_frame import first_frame
from restshape.mesh.imported_curves import BoundaryChain
from restshape.mesh.importer import read_mesh
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.scene.load import load_scene

A, SIDE = 0.1, 0.5
S = 1e6
R2, ANGLE = "(x^2 + y^2)", "atan2(y, x)"
FAR = {
    "xx": f"{S}*(1 - {A}^2/{R2}*(1.5*cos(2*{ANGLE}) + cos(4*{ANGLE})) + 1.5*{A}^4/{R2}^2*cos(4*{ANGLE}))",
    "xy": f"{S}*(-{A}^2/{R2}*(0.5*sin(2*{ANGLE}) + sin(4*{ANGLE})) + 1.5*{A}^4/{R2}^2*sin(4*{ANGLE}))",
    "yy": f"{S}*(-{A}^2/{R2}*(0.5*cos(2*{ANGLE}) - cos(4*{ANGLE})) - 1.5*{A}^4/{R2}^2*cos(4*{ANGLE}))",
}
"""Kirsch's stresses in an infinite plate, pulled along x, as formulas."""


class Drawn:
    """A mesh by gmsh, in a file."""

    def __enter__(self):
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("drawn")
        return gmsh.model.geo

    def __exit__(self, *_):
        gmsh.finalize()


def written(path: Path, order: int) -> Path:
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)
    gmsh.write(str(path))
    return path


def quarter(path: Path, order: int, ratio: float = 1.0) -> Path:
    """A quarter of a plate with a round hole, or one that is an ellipse; its edges, drawn 1 to 5, have groups."""
    with Drawn() as geo:
        centre = geo.addPoint(0, 0, 0)
        places = [(A, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE), (0, ratio * A)]
        p = [geo.addPoint(*place, 0) for place in places]
        lines = [geo.addLine(p[i], p[i + 1]) for i in range(4)]
        hole = geo.addCircleArc(p[4], centre, p[0]) if ratio == 1 else geo.addEllipseArc(p[4], centre, p[4], p[0])
        surface = geo.addPlaneSurface([geo.addCurveLoop([*lines, hole])], 20)
        geo.mesh.setTransfiniteCurve(hole, 15)
        geo.mesh.setTransfiniteCurve(lines[0], 19, "Progression", 1.1)
        geo.mesh.setTransfiniteCurve(lines[3], 19, "Progression", -1.1)
        for far in lines[1:3]:
            geo.mesh.setTransfiniteCurve(far, 9)
        geo.synchronize()
        for i, line in enumerate((*lines, hole)):
            gmsh.model.addPhysicalGroup(1, [line], 10 + i, name=("bottom", "right", "top", "left", "hole")[i])
        gmsh.model.addPhysicalGroup(2, [surface], 20, name="plate")
        return written(path, order)


def slot(path: Path, order: int) -> Path:
    """A square with a slot: two half circles and the lines between them, which meet without a corner."""
    with Drawn() as geo:
        square = [geo.addPoint(*place, 0, 0.1) for place in ((0, 0), (1, 0), (1, 1), (0, 1))]
        outer = geo.addCurveLoop([geo.addLine(square[i], square[(i + 1) % 4]) for i in range(4)])
        left, right = (geo.addPoint(x, 0.5, 0) for x in (0.35, 0.65))
        ends = [geo.addPoint(x, y, 0) for x, y in ((0.35, 0.4), (0.65, 0.4), (0.65, 0.6), (0.35, 0.6))]
        middle = geo.addPoint(0.75, 0.5, 0), geo.addPoint(0.25, 0.5, 0)
        way = [
            geo.addLine(ends[0], ends[1]),
            geo.addCircleArc(ends[1], right, middle[0]),
            geo.addCircleArc(middle[0], right, ends[2]),
            geo.addLine(ends[2], ends[3]),
            geo.addCircleArc(ends[3], left, middle[1]),
            geo.addCircleArc(middle[1], left, ends[0]),
        ]
        for curve in way:
            geo.mesh.setTransfiniteCurve(curve, 7)
        geo.addPlaneSurface([outer, geo.addCurveLoop(way)])
        geo.synchronize()
        return written(path, order)


def scene_of(mesh: Path, *, on: dict[str, str], order: int = 2) -> Path:
    """Kirsch's plate on a mesh file, whose entities have these names."""
    loads = [f'[loads.right]\non = "{on["right"]}"\ntraction = ["{FAR["xx"]}", "{FAR["xy"]}"]']
    loads += [f'[loads.top]\non = "{on["top"]}"\ntraction = ["{FAR["xy"]}", "{FAR["yy"]}"]']
    path = mesh.with_suffix(".toml")
    path.write_text(
        "\n".join(
            [
                head("plane"),
                '[material.steel]\nE = "210 GPa"\nnu = 0.3\nthickness = 1\n',
                '[effects.solid]\nmodel = "plane_stress"',
                f'[supports.x]\non = "{on["left"]}"\nfix = ["x"]\n[supports.y]\non = "{on["bottom"]}"\nfix = ["y"]',
                *loads,
                f'[mesh]\nfile = "{mesh.name}"\norder = {order}',
                f'[quantities]\nhighest = {{ stress = "xx", at = "{on["hole"]}", reduce = "max" }}',
                f'lowest = {{ stress = "yy", at = "{on["hole"]}", reduce = "min" }}\n',
            ]
        )
    )
    return path


NAMES = {name: name for name in ("bottom", "right", "top", "left", "hole")}
PROPERTIES = {name: f"property_{1 + i}" for i, name in enumerate(("bottom", "right", "top", "left", "hole"))}


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("ending", ["msh", "inp", "bdf"])
def test_a_round_hole_has_the_stresses_of_kirsch(tmp_path, ending, order):
    """Of files of either order, by gmsh: straight sides would be 2 to 4 % off."""
    mesh = quarter(tmp_path / f"plate.{ending}", order)
    outline = read_mesh(mesh)[1]
    kinds = [edge.kind for edge in outline.edges]
    assert sorted(kinds) == ["arc", "line", "line", "line", "line"]
    assert outline.area() == pytest.approx(SIDE**2 - np.pi * A**2 / 4, rel=1e-5)
    row = first_frame(scene_of(mesh, on=PROPERTIES if ending == "bdf" else NAMES)).row
    assert row["q_highest"] == pytest.approx(3 * S, rel=5e-3)
    assert row["q_lowest"] == pytest.approx(-S, rel=2e-2)


def test_nodes_in_the_middle_of_other_curves_are_kept(tmp_path):
    """A hole that is an ellipse: its edge goes through all nodes of the file, and second order stands on them."""
    path = quarter(tmp_path / "ellipse.msh", 2, 0.5)
    mesh, outline = read_mesh(path)
    assert outline.edges[[e.name for e in outline.edges].index("hole")].kind == "spline"
    space = LagrangeSpace(mesh)
    x, y = space.X[space.nodes_of("hole")].T
    assert len(x) == 29
    assert np.abs((x / A) ** 2 + (y / (0.5 * A)) ** 2 - 1).max() < 1e-6
    assert outline.area() == pytest.approx(SIDE**2 - np.pi * A**2 / 8, rel=1e-5)


def test_straight_sides_are_reported_where_the_file_has_no_curve(tmp_path):
    path = scene_of(quarter(tmp_path / "ellipse.msh", 1, 0.5), on=NAMES)
    scene = load_scene(path)
    outline = read_mesh(path.with_suffix(".msh"))[1]
    assert any("sides on hole stay straight" in doubt for doubt in doubts(scene, outline))
    second = scene_of(quarter(tmp_path / "second.msh", 2, 0.5), on=NAMES, order=1)
    reported = doubts(load_scene(second), read_mesh(second.with_suffix(".msh"))[1])
    assert any("only their corners are used" in doubt for doubt in reported)
    assert not any("stay straight" in doubt for doubt in reported)


@pytest.mark.parametrize("order", [1, 2])
def test_arcs_and_lines_that_meet_without_a_corner(tmp_path, order):
    outline = read_mesh(slot(tmp_path / "slot.msh", order))[1]
    assert outline.area() == pytest.approx(1.0 - 0.3 * 0.2 - np.pi * 0.1**2, rel=1e-9)
    hole = next(loop for loop in outline.loops if loop.kind == "hole")
    assert {outline.edges[edge].kind for edge, _ in hole.edges} == {"arc", "line"}


def with_round_hole(path: Path, sides: int, order: int) -> Path:
    """A square with a round hole of so many sides."""
    with Drawn() as geo:
        square = [geo.addPoint(*place, 0, 0.2) for place in ((0, 0), (1, 0), (1, 1), (0, 1))]
        outer = geo.addCurveLoop([geo.addLine(square[i], square[(i + 1) % 4]) for i in range(4)])
        middle = geo.addPoint(0.5, 0.5, 0)
        turns = [2.0 * np.pi * k / sides for k in range(sides)]
        ends = [geo.addPoint(0.5 + 0.2 * np.cos(t), 0.5 + 0.2 * np.sin(t), 0) for t in turns]
        arcs = [geo.addCircleArc(ends[k], middle, ends[(k + 1) % sides]) for k in range(sides)]
        for arc in arcs:
            geo.mesh.setTransfiniteCurve(arc, 2)
        geo.addPlaneSurface([outer, geo.addCurveLoop(arcs)])
        geo.synchronize()
        return written(path, order)


@pytest.mark.parametrize(("sides", "order"), [(8, 1), (11, 1), (12, 1), (4, 2), (11, 2)])
def test_a_hole_of_few_sides_is_round(tmp_path, sides, order):
    outline = read_mesh(with_round_hole(tmp_path / "a.msh", sides, order))[1]
    assert outline.area() == pytest.approx(1.0 - np.pi * 0.2**2, rel=1e-9)
    hole = next(loop for loop in outline.loops if loop.kind == "hole")
    assert [outline.edges[edge].kind for edge, _ in hole.edges] == ["arc", "arc"]


def test_a_hexagon_of_straight_sides_stays_one(tmp_path):
    outline = read_mesh(with_round_hole(tmp_path / "a.msh", 6, 1))[1]
    assert outline.area() == pytest.approx(1.0 - 1.5 * np.sqrt(3.0) * 0.2**2, rel=1e-9)


def chain(points: np.ndarray) -> BoundaryChain:
    return BoundaryChain(points, [None] * (len(points) - 1))


def test_runs_on_circles_are_found_and_others_are_not():
    turn = np.linspace(0.0, 0.5 * np.pi, 9)
    arc = np.column_stack([np.cos(turn), np.sin(turn)])
    assert chain(arc).arc(0, 8) == pytest.approx(0.5 * np.pi)
    assert chain(arc[::-1]).arc(0, 8) == pytest.approx(-0.5 * np.pi)
    line = arc[-1] + np.column_stack([-np.arange(1, 6) * 0.2, np.zeros(5)])
    assert chain(np.vstack([arc, line])).stops() == [0, 8, 13]
    other = arc[-1] * 0 + np.column_stack([-np.sin(turn[1:]) * 0.3, 0.7 + 0.3 * np.cos(turn[1:])])
    assert chain(np.vstack([arc, other])).stops() == [0, 8, 16]
    wave = np.column_stack([turn, 0.2 * np.sin(3 * turn)])
    assert not chain(wave).is_arc(0, 8) and not chain(arc * [1, 0.8]).is_arc(0, 8)
    # A circle in a file with four digits is known by nothing but its corners.
    assert chain(np.round(arc, 6)).is_arc(0, 8) and not chain(np.round(arc, 2)).is_arc(0, 8)
