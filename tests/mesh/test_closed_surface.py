"""Closed surfaces of files: formats, units, holes, and what makes none."""

import numpy as np
import pytest
from body_meshes import ball, box, torus, write

from restshape.errors import UserError
from restshape.mesh.closed_surface import read_closed_surface


@pytest.mark.parametrize("name", ["ring.obj", "ring.stl", "ring.ply"])
def test_all_formats_give_one_closed_surface(tmp_path, name):
    X, cells = torus(40, 20, 0.3, 0.1)
    surface = read_closed_surface(write(tmp_path / name, (X, cells)))
    assert surface.X.shape == X.shape and surface.cells.shape == cells.shape
    assert surface.volume == pytest.approx(2.0 * np.pi**2 * 0.3 * 0.1**2, rel=0.03)
    assert surface.unit == 1.0 and surface.guessed and not surface.holes and not surface.turned


@pytest.mark.parametrize("size, metres", [(1.7, 1.0), (170.0, 1e-2), (1700.0, 1e-3)])
def test_the_unit_is_guessed_from_the_longest_side(tmp_path, size, metres):
    X, cells = box((0.1 * size, 0.2 * size, 0.5 * size))
    surface = read_closed_surface(write(tmp_path / "tall.obj", (X, cells)))
    assert surface.unit == metres and np.ptp(surface.X, axis=0).max() == pytest.approx(1.7)


@pytest.mark.parametrize("size", [0.01, 1e5])
def test_unlikely_sizes_need_a_unit(tmp_path, size):
    path = write(tmp_path / "odd.obj", box((size, size, size)))
    with pytest.raises(UserError, match=r"cannot be guessed.*\n.*unit ="):
        read_closed_surface(path)
    assert read_closed_surface(path, 1e-3).X.max() == pytest.approx(1e-3 * size)


def test_a_small_hole_is_closed_and_counted(tmp_path):
    X, cells = ball(8, 0.5)
    kept = np.linalg.norm(X[cells].mean(axis=1) - (0.0, 0.0, 0.5), axis=1) > 0.08
    surface = read_closed_surface(write(tmp_path / "scan.ply", (X, cells[kept])))
    (hole,) = surface.holes
    assert hole.edges >= 3 and 0.05 < hole.width < 0.3 and hole.center[2] == pytest.approx(0.5, abs=0.03)
    assert surface.volume == pytest.approx(
        read_closed_surface(write(tmp_path / "all.ply", (X, cells))).volume, rel=0.01
    )


def test_triangles_that_look_inwards_are_turned_over(tmp_path):
    X, cells = ball(4, 0.5)
    surface = read_closed_surface(write(tmp_path / "inside_out.ply", (X, cells[:, ::-1])))
    assert surface.turned and surface.volume > 0.0


def test_texture_coordinates_of_another_number_do_not_matter(tmp_path):
    lines = [f"v {x} {y} {z} 0.5 0.5 0.5" for x, y, z in box((0.2, 0.2, 0.2))[0]]
    faces = [" ".join(f"{i + 1}/{k + 1}" for i in cell) for k, cell in enumerate(box((0.2, 0.2, 0.2))[1])]
    (tmp_path / "skin.obj").write_text("\n".join([*lines, *["vt 0 0"] * 12, *(f"f {face}" for face in faces)]))
    assert read_closed_surface(tmp_path / "skin.obj").volume == pytest.approx(0.4**3)


def test_triangles_in_a_line_close_what_they_join(tmp_path):
    """A box with a corner on one edge that one of the two triangles there does not have, and a sliver between them."""
    X, cells = box((0.5, 0.5, 0.5))
    a, b, c = cells[0].tolist()
    # The first triangle is cut in two from its corner c to the middle of a and b.
    cut = [[a, len(X), c], [len(X), b, c], [a, b, len(X)]]
    path = write(tmp_path / "cut.ply", (np.vstack([X, 0.5 * (X[a] + X[b])]), np.vstack([cells[1:], cut])))
    surface = read_closed_surface(path)
    assert surface.holes == () and surface.volume == pytest.approx(1.0)
    assert (surface.areas == 0.0).sum() == 1 and surface.areas.sum() == pytest.approx(6.0)


def _open(X, cells):
    return X, cells[X[cells].mean(axis=1)[:, 2] < 0.2]


def _unlike(X, cells):
    cells = cells.copy()
    cells[7] = cells[7, ::-1]
    return X, cells


def _walled(X, cells):
    return np.vstack([X, np.zeros(3)]), np.vstack([cells, [cells[0, 0], cells[0, 1], len(X)]])


@pytest.mark.parametrize(
    "change, what",
    [
        (_open, "the surface is open: it has a hole"),
        (_unlike, "look to unlike sides"),
        (_walled, "odd number of triangles"),
        (lambda X, cells: (X, cells[:0]), "no triangles|can be read"),
        (lambda X, cells: (X * (1.0, 1.0, 0.0), cells), "no volume|odd number|without area"),
        (lambda X, cells: (np.where(X > 0.4, np.nan, X), cells), "no place in space"),
    ],
)
def test_what_is_no_body_is_refused_with_its_file(tmp_path, change, what):
    path = write(tmp_path / "bad.ply", change(*ball(6, 0.5)))
    with pytest.raises(UserError, match=what) as refused:
        read_closed_surface(path)
    assert "bad.ply" in str(refused.value) and refused.value.do


def test_files_that_are_none_are_refused(tmp_path):
    (tmp_path / "text.obj").write_text("f 1 2 9\nv 0 0 0\nv 1 0 0\n")
    (tmp_path / "back.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\n")
    faces = "f 4294967297 2 4\nf 1 2 3\nf 1 3 4\nf 2 3 4\n"
    (tmp_path / "huge.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + faces)
    refusals = {
        "text.obj": "not there",
        "huge.obj": "not there",
        "back.obj": "backwards",
        "none.obj": "no such",
        "x.doc": "no such",
    }
    for name, what in refusals.items():
        with pytest.raises(UserError, match=what):
            read_closed_surface(tmp_path / name)


def test_a_binary_file_that_is_cut_off_says_so(tmp_path):
    path = tmp_path / "cut.stl"
    path.write_bytes(b"made by hand".ljust(80) + (12).to_bytes(4, "little") + bytes(4 * 50 + 16))
    with pytest.raises(UserError, match="cut off: it announces 12 triangles and holds 4"):
        read_closed_surface(path)
