"""Meshes from files of each format, and what is said about broken ones."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from restshape.errors import UserError
from restshape.mesh.generate import generate
from restshape.mesh.importer import read_mesh
from restshape.scene.model import MeshSpec
from restshape.shape.validity import problem

SAMPLES = Path(__file__).parents[2] / "meshes"
ENDINGS = ("inp", "bdf", "msh", "vtu")
NAMES = {
    "inp": {"clamp": "clamp", "load": "load", "bolt": "bolt", "corner": "corner", "bracket": "bracket"},
    "msh": {"clamp": "clamp", "load": "load", "bolt": "bolt", "corner": "corner"},
    "bdf": {"clamp": "SPC_1", "corner": "property_2"},
    "vtu": {"clamp": "group_1", "load": "group_2", "bolt": "group_3", "corner": "group_11"},
}
L_AREA = 30 * 8 + 10 * 12
CORNER_AREA = 7 * 5


def areas(mesh) -> np.ndarray:
    a, b, c = (mesh.X[mesh.cells[:, i]] for i in range(3))
    return 0.5 * np.cross(b - a, c - a)


def round_hole_area() -> float:
    """Area [m^2] of the bolt's hole."""
    return np.pi * 1.8e-3**2


def polygon_hole_area(mesh) -> float:
    """Area of the bolt's hole, from its nodes sorted by angle."""
    ring = mesh.X[np.hypot(*(mesh.X - (22e-3, 4e-3)).T) < 1.9e-3]
    order = np.argsort(np.arctan2(*(ring - (22e-3, 4e-3)).T[::-1]))
    x, y = ring[order].T
    return 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))


@pytest.mark.parametrize("ending", ENDINGS)
def test_each_format_gives_the_same_mesh_and_its_names(ending):
    mesh, outline = read_mesh(SAMPLES / f"bracket.{ending}", 1e-3)
    assert areas(mesh).min() > 0
    assert areas(mesh).sum() == pytest.approx(L_AREA * 1e-6 - polygon_hole_area(mesh), rel=1e-6)
    assert outline.area() == pytest.approx(L_AREA * 1e-6 - round_hole_area(), rel=1e-6)
    assert mesh.n_nodes - len(mesh.edge_nodes) + mesh.n_cells == 0
    assert problem(outline) is None
    names = NAMES[ending]
    assert np.allclose(mesh.X[mesh.nodes_of(names["clamp"]), 0], 0.0)
    assert np.ptp(mesh.X[mesh.nodes_of(names["clamp"]), 1]) == pytest.approx(0.02)
    assert areas(mesh)[mesh.cells_of(names["corner"])].sum() == pytest.approx(CORNER_AREA * 1e-6, rel=1e-4)
    if "load" in names:
        assert np.allclose(mesh.X[mesh.nodes_of(names["load"]), 0], 0.03)
        radius = np.hypot(*(mesh.X[mesh.nodes_of(names["bolt"])] - (22e-3, 4e-3)).T)
        assert np.allclose(radius, 1.8e-3, rtol=1e-6)
    if "bracket" in names:
        assert len(mesh.cells_of("bracket")) == mesh.n_cells


@pytest.mark.parametrize("ending", ENDINGS)
def test_imported_outline_can_be_meshed_again(ending):
    mesh, outline = read_mesh(SAMPLES / f"bracket.{ending}", 1e-3)
    fine = generate(outline, MeshSpec(size=0.6e-3))
    assert fine.n_cells > 3 * mesh.n_cells
    assert areas(fine).sum() == pytest.approx(outline.area(), rel=1e-3)
    for name in NAMES[ending].values():
        whole = len(mesh.cells_of(name)) == mesh.n_cells
        inside = [areas(m)[m.cells_of(name)].sum() for m in (fine, mesh)]
        assert inside[0] == pytest.approx(inside[1], rel=1e-3 if whole else 1e-9)
        old, new = (m.X[m.facets[m.facets_of(name)]] for m in (mesh, fine))
        lengths = [np.linalg.norm(x[:, 1] - x[:, 0], axis=1).sum() for x in (old, new)]
        # The bolt's hole is round, and has more sides now.
        assert lengths[1] == pytest.approx(lengths[0], rel=0.02 if name in ("bolt", "group_3", "bracket") else 1e-9)


def test_facets_and_parameters_fit_the_outline():
    mesh, outline = read_mesh(SAMPLES / "bracket.inp", 1e-3)
    for node in np.flatnonzero(mesh.node_edge >= 0):
        at = outline.point(int(mesh.node_edge[node]), mesh.node_param[node])[0]
        assert np.allclose(mesh.X[node], at, atol=1e-15)
    a, b = mesh.X[mesh.facets[:, 0]], mesh.X[mesh.facets[:, 1]]
    inside = mesh.X[mesh.cells[mesh.facet_cell]].mean(axis=1)
    assert np.cross(b - a, inside - a).min() > 0
    # Six corners of the L, four of the region, two that cut the round hole open.
    assert len(outline.vertex_names) == 12


GRID = np.array([[x, y, 0.0] for y in range(3) for x in range(4)], dtype=float)
QUADS = np.array([[4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4] for j in range(2) for i in range(3)])


def test_quadrilaterals_are_cut_clockwise_cells_turned_and_orphans_dropped(tmp_path):
    points = np.vstack([GRID, [[9.0, 9.0, 0.0]]])
    path = tmp_path / "grid.vtu"
    meshio.write(path, meshio.Mesh(points, [("quad", QUADS[:, ::-1])]))
    mesh, outline = read_mesh(path)
    assert mesh.n_cells == 12 and mesh.n_nodes == 12
    assert np.allclose(areas(mesh), 0.5)
    assert len(outline.edges) == 4 and outline.area() == pytest.approx(6.0)
    assert all(edge.kind == "line" for edge in outline.edges)


def test_single_nodes_become_vertices_and_embedded_points(tmp_path):
    text = ["*NODE", *(f"{i + 1}, {x}, {y}, 0" for i, (x, y, _) in enumerate(GRID))]
    text += ["*ELEMENT, TYPE=CPE4", *(f"{i + 1}, " + ", ".join(str(n + 1) for n in q) for i, q in enumerate(QUADS))]
    text += ["*NSET, NSET=tip", "2", "*NSET, NSET=core", "6", "*NSET, NSET=feet", "1, 4", "*NSET, NSET=every"]
    text += [", ".join(str(i + 1) for i in range(12)), "*ELSET, ELSET=right", "3, 6"]
    path = tmp_path / "grid.inp"
    path.write_text("\n".join(text) + "\n")
    mesh, outline = read_mesh(path)
    assert np.array_equal(mesh.X[mesh.nodes_of("tip")], [[1.0, 0.0]])
    assert np.array_equal(mesh.X[mesh.nodes_of("core")], [[1.0, 1.0]])
    assert sorted(mesh.X[mesh.nodes_of("feet")].tolist()) == [[0.0, 0.0], [3.0, 0.0]]
    assert len(mesh.nodes_of("every")) == 12
    assert areas(mesh)[mesh.cells_of("right")].sum() == pytest.approx(2.0)
    fine = generate(outline, MeshSpec(size=0.2))
    assert np.array_equal(fine.X[fine.nodes_of("core")], [[1.0, 1.0]])
    assert areas(fine)[fine.cells_of("right")].sum() == pytest.approx(2.0)


def test_overlapping_and_surrounding_element_sets_keep_their_cells(tmp_path):
    n = 9
    axis = np.linspace(0.0, 1.0, n + 1)
    points = np.array([[x, y, 0.0] for y in axis for x in axis])
    quads = np.array([[(n + 1) * j + i + k for k in (0, 1, n + 2, n + 1)] for j in range(n) for i in range(n)])
    row, column = np.divmod(np.arange(n * n), n)
    ring = np.maximum(np.abs(row - 4), np.abs(column - 4))
    sets = {"frame": ring == 3, "heart": ring <= 1, "middle": ring <= 3, "west": column < 4}
    path = tmp_path / "sets.inp"
    text = ["*NODE", *(f"{i + 1}, {x:.17g}, {y:.17g}, 0" for i, (x, y, _) in enumerate(points))]
    text += ["*ELEMENT, TYPE=CPS4", *(f"{i + 1}, " + ", ".join(str(k + 1) for k in q) for i, q in enumerate(quads))]
    for name, inside in sets.items():
        text += [f"*ELSET, ELSET={name}", *(str(i + 1) for i in np.flatnonzero(inside))]
    path.write_text("\n".join(text) + "\n")
    mesh, outline = read_mesh(path)
    fine = generate(outline, MeshSpec(size=0.05))
    for name, inside in sets.items():
        for m in (mesh, fine):
            assert areas(m)[m.cells_of(name)].sum() == pytest.approx(inside.sum() / n**2, rel=1e-9), name


def test_free_field_nastran_with_two_kinds_of_constraint(tmp_path):
    cards = ["CEND", "BEGIN BULK", *(f"GRID,{10 * i + 10},,{x},{y},0." for i, (x, y, _) in enumerate(GRID))]
    cards += [f"CQUAD4,{i + 1},1," + ",".join(str(10 * n + 10) for n in q) for i, q in enumerate(QUADS)]
    cards += ["SPC1,7,12,10,50,90", "SPC,8,40,1,0.,80,1,0.", "SPC,8,120,1,0.", "SPC1,9,2,10,THRU,11", "ENDDATA"]
    path = tmp_path / "free.bdf"
    path.write_text("\n".join(card for card in cards if "THRU" not in card) + "\n")
    mesh, _ = read_mesh(path)
    assert sorted(mesh.X[mesh.nodes_of("SPC_7")].tolist()) == [[0.0, 0.0], [0.0, 1.0], [0.0, 2.0]]
    assert sorted(mesh.X[mesh.nodes_of("SPC_8")].tolist()) == [[3.0, 0.0], [3.0, 1.0], [3.0, 2.0]]
    path.write_text("\n".join(cards) + "\n")
    with pytest.raises(UserError, match="SPC_9 names node 11"):
        read_mesh(path)


def test_names_that_every_outline_has_get_an_underscore(tmp_path):
    path = tmp_path / "named.msh"
    sides = np.array([[0, 1], [1, 2], [2, 3]])
    tags = [np.array([1, 1, 1]), np.full(6, 2)]
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    names = {"outline": np.array([1, 1]), "all": np.array([2, 2])}
    grid = meshio.Mesh(GRID, [("line", sides), ("quad", QUADS)], cell_data=data, field_data=names)
    meshio.write(path, grid, file_format="gmsh22", binary=False)
    mesh, _ = read_mesh(path)
    assert np.allclose(mesh.X[mesh.nodes_of("outline_"), 1], 0.0)
    assert len(mesh.cells_of("all_")) == 12
    assert len(mesh.facets_of("outline")) == 10


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
INVALID = {
    "solid": ([*SQUARE[:3], [0, 0, 1]], [("tetra", [[0, 1, 2, 3]])], "tetra"),
    "out of plane": ([*SQUARE[:3], [0, 1, 0.3]], [("triangle", [[0, 1, 2], [0, 2, 3]])], "plane z = 0"),
    "no triangles": (SQUARE, [("line", [[0, 1]])], "no triangles"),
    "degenerate": ([*SQUARE, [2, 0, 0]], [("triangle", [[0, 1, 2], [0, 2, 3], [0, 1, 4]])], "triangle 3.*no area"),
    "same place": ([*SQUARE, [1, 1, 0]], [("triangle", [[0, 1, 2], [0, 4, 3]])], "nodes 3 and 5"),
    "three at a side": (
        [*SQUARE, [0.5, -1, 0], [0.5, 2, 0]],
        [("triangle", [[0, 1, 2], [0, 1, 4], [0, 1, 5]])],
        "more than two elements",
    ),
    "folded": ([*SQUARE, [0.9, 0.2, 0]], [("triangle", [[0, 1, 2], [0, 2, 4]])], "inverted"),
    "two parts": (
        [*SQUARE[:3], [5, 0, 0], [6, 0, 0], [6, 1, 0]],
        [("triangle", [[0, 1, 2], [3, 4, 5]])],
        "2 separate parts",
    ),
    "bow tie": (
        [*SQUARE[:3], [2, 1, 0], [2, 2, 0]],
        [("triangle", [[0, 1, 2], [2, 3, 4]])],
        "touches itself at \\(1, 1\\)",
    ),
    "not a number": ([*SQUARE[:2], [1, np.nan, 0]], [("triangle", [[0, 1, 2]])], "node 3"),
}


@pytest.mark.parametrize("name", INVALID)
def test_invalid_meshes_are_refused_with_the_file_and_the_reason(tmp_path, name):
    points, cells, message = INVALID[name]
    path = tmp_path / "broken.vtu"
    blocks = [(kind, np.array([list(cell) for cell in rows])) for kind, rows in cells]
    meshio.write(path, meshio.Mesh(np.array(points, dtype=float), blocks))
    with pytest.raises(UserError, match=message) as raised:
        read_mesh(path)
    assert "broken.vtu" in str(raised.value)


TEXTS = {
    "empty.inp": ("", "empty"),
    "torn.inp": ("*NODE\n1, 0, 0, 0\n2, 1, zero, 0\n", "abaqus"),
    "beam.inp": ("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n*ELEMENT, TYPE=NONSENSE\n1, 1, 2, 3\n", "NONSENSE"),
    "lost.inp": ("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n", "abaqus"),
    "no_nodes.inp": ("*HEADING\nnothing\n", "no nodes"),
    "torn.msh": ("$MeshFormat\n2.2 0 8\n", "no nodes"),
    "wrong.msh": ("hello\n", "gmsh"),
    "torn.vtu": ("<VTKFile type='UnstructuredGrid'><Unstr", "vtu"),
    "no_bulk.bdf": ("GRID,1,,0.,0.,0.\n", "no triangles"),
    "no_grid.bdf": ("BEGIN BULK\n", "no GRID card"),
    "torn.bdf": ("BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.", "nastran"),
    "plate.step": ("ISO-10303-21;", "is no mesh"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_unreadable_files_are_refused_with_the_file_and_the_reason(tmp_path, capfd, name):
    text, message = TEXTS[name]
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(UserError, match=message) as raised:
        read_mesh(path)
    assert name in str(raised.value)
    assert capfd.readouterr().out == ""


def test_missing_file_is_the_users_mistake(tmp_path):
    with pytest.raises(UserError, match=r"gone\.msh: there is no such mesh file"):
        read_mesh(tmp_path / "gone.msh")
