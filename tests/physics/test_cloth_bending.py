"""Bending of cloth against closed forms on five kinds of mesh: hinges, which see the mesh, and Morley's triangle."""

import numpy as np
import pytest
from bending_kinds import (
    KINDS,
    Plate,
    hinge_energy,
    hinge_share,
    plate_share,
    rim,
    rolled,
    rolled_share,
    sheet,
    strip_share,
)

from restshape import _kernels as k
from restshape.mesh.hinges import hinges

# Energy of cylinders along x and at 45 degrees and of a sphere over area/2 (k1 + k2)^2, and the plate that hinges of
# k = 1 make. Equilateral triangles store 3/2 (k1^2 + k2^2) - k1 k2 an area, a plate of D = 3 with nu = -1/3. Squares
# with a diagonal have hinges of |e|^2/area = 1 along x and y, 2 along the diagonal: sums over one square.
HINGES = {
    "equilateral": (3.0, 3.0, 1.0, 3.0),
    "diagonal": (3.0, 9.0, 1.5, 5.4),
    "crossed": (4.5, 3.0, 1.5, 2.5),
    "jittered": (3.05, 4.1, 1.2, 3.9),
}


@pytest.mark.parametrize("kind", HINGES)
def test_hinges_have_the_energies_of_their_mesh(kind):
    shares = [hinge_share(kind, surface, 12) for surface in ("cylinder", "cylinder at 45", "sphere")]
    np.testing.assert_allclose(shares, HINGES[kind][:3], rtol=0.06 if kind == "jittered" else 1e-9)


@pytest.mark.parametrize("kind", HINGES)
def test_hinges_make_the_plate_of_their_mesh(kind):
    np.testing.assert_allclose(1 / plate_share(kind, "hinge", 32), HINGES[kind][3], rtol=0.03)


def test_a_narrow_strip_of_hinges_on_equilateral_triangles_has_8_over_3():
    """D (1 - nu^2) with D = 3, nu = -1/3."""
    np.testing.assert_allclose(strip_share("equilateral", "hinge", 96), 3 / 8, rtol=0.02)


def test_refinement_does_not_help_hinges():
    shares = [3 * plate_share("diagonal", "hinge", n) for n in (12, 48)]
    assert max(shares) < 0.6


def rate(errors) -> float:
    """Order of errors of meshes that are refined by two."""
    assert errors[-1] < errors[0]
    return np.log2(errors[0] / errors[-1]) / (len(errors) - 1)


@pytest.mark.parametrize("kind", KINDS[1:])
def test_clamped_plate_of_morley_triangles(kind):
    """0.00126532 q a^4/D in the middle of a square: R. L. Taylor, S. Govindjee, Solution of clamped rectangular plate
    problems, Commun. Numer. Meth. Engng 20 (2004) 757. Rows of equilateral triangles make no square."""
    errors = []
    for n in (6, 12, 24):
        mesh = sheet(kind, n)
        w = Plate(mesh, "morley", nu=0.3).deflection(rim(mesh), rim(mesh))
        errors.append(abs(w.max() / 0.00126532 - 1))
    assert errors[-1] < 0.04
    assert rate(errors) > 1.8


@pytest.mark.parametrize("kind", KINDS)
class TestMorley:
    """Each load case of D = 1 under a load of 1 an area."""

    @pytest.mark.parametrize("nu", [0.0, 0.3])
    def test_simply_supported_plate(self, kind, nu):
        """Navier's series."""
        errors = [abs(plate_share(kind, "morley", n, nu) - 1) for n in (6, 12, 24)]
        assert errors[-1] < 0.007
        assert rate(errors) > 1.6

    def test_cantilever_strip_with_free_sides(self, kind):
        """q L^4/(8 D) at the tip, nu = 0."""
        errors = []
        for n in (8, 16, 32):
            mesh = sheet(kind, n, 1.0, 0.25)
            left = lambda X: X[:, 0] < 1e-9  # noqa: E731
            w = Plate(mesh, "morley").deflection(left, left)
            errors.append(abs(w[mesh.X[:, 0] > 1 - 1e-9].mean() * 8 - 1))
        assert errors[-1] < 0.002
        assert rate(errors) > 1.6

    def test_strip_on_two_supports_with_free_sides(self, kind):
        """5 q L^4/(384 D) in the middle, nu = 0."""
        errors = [abs(strip_share(kind, "morley", n) - 1) for n in (16, 64)]
        assert errors[-1] < 0.002

    def test_a_free_sheet_has_the_rigid_modes_and_no_others(self, kind):
        """Deflections: a shift and two tilts. Nothing like the null modes of vertex forms at free edges."""
        values = np.linalg.eigvalsh(Plate(sheet(kind, 6), "morley", nu=0.3).K.toarray())
        assert np.abs(values[:3]).max() < 1e-11 * values[-1] and values[3] > 1e-5 * values[-1]

    def test_a_rolled_sheet_has_the_energy_of_its_curvature(self, kind):
        """1/(2 r^2) an area on a roll over two radians, to second order in the turn of a triangle."""
        errors = [abs(rolled_share(kind, "morley", n) - 1) for n in (8, 16, 32)]
        assert errors[-1] < 0.001
        assert rate(errors) > 1.6


@pytest.mark.parametrize("kind", KINDS)
def test_hinges_do_not_mind_rigid_motions_of_a_sheet(kind):
    mesh = sheet(kind, 8)
    flat = np.column_stack([mesh.X, np.zeros(len(mesh.X))])
    turned = flat @ np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0] + 5.0
    assert hinge_energy(mesh, turned) < 1e-24
    assert hinge_energy(mesh, turned, "hinge_nonlinear_flap4") < 1e-24
    pull = np.zeros_like(flat)
    k.Element("hinge_flap4").residual(mesh.X, turned, hinges(mesh.cells, mesh.cell_edges), np.ones(1), pull)
    np.testing.assert_allclose(pull, 0.0, atol=1e-11)


def test_angles_and_chords_of_hinges_agree_on_fine_meshes():
    """2 sin(t/2) against t, on a sheet rolled tightly: apart by t^2/24 for hinges across the roll."""
    apart = []
    for n in (8, 16, 32):
        mesh = sheet("diagonal", n)
        x = rolled(mesh.X, 0.2)
        apart.append(1 - hinge_energy(mesh, x) / hinge_energy(mesh, x, "hinge_nonlinear_flap4"))
    assert 0 < apart[-1] < 0.01
    np.testing.assert_allclose(np.log2(np.array(apart[:-1]) / apart[1:]), 2.0, atol=0.2)
