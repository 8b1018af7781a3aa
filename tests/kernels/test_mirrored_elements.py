"""Half hinges about edges in a mirror: the inherited checks, whole sheets halved, and the cantilever in closed form."""

import itertools

import numpy as np
import pytest
from element_case import TRI3, ElementCase
from sample_meshes import unit_box
from scipy.spatial.transform import Rotation

from restshape import _kernels as k
from restshape.mesh.hinges import hinges
from restshape.mesh.mesh import edges_of_cells
from restshape.physics.cloth.sheet.parameters import HINGE_STIFFNESS, lumped

ALONG = np.array([0.6, -0.5, 0.0])
T = ALONG / np.linalg.norm(ALONG)
PAIRS = {"hinge_flap4": "hinge_mirrored_flap3", "hinge_nonlinear_flap4": "hinge_nonlinear_mirrored_flap3"}


def mirror_of(X: np.ndarray, x: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Material coordinates and positions (4, .) with the image of the last of three corners."""
    e = (X[1] - X[0]) / np.linalg.norm(X[1] - X[0])
    image = X[0] + (2 * np.outer(e, e) - np.eye(2)) @ (X[2] - X[0])
    reflected = x[0] + (np.eye(3) - 2 * np.outer(t, t)) @ (x[2] - x[0])
    return np.vstack([X, image]), np.vstack([x, reflected])


class MirroredCase(ElementCase):
    """Against the whole hinge on a cell and its image."""

    whole: str
    params = (0.7, *T)
    cell4 = np.arange(4, dtype=np.int32)[None]

    def sample(self, element, seed):
        lifted = np.column_stack([self.X, [0.0, 0.0, 0.5]])
        return lifted + 0.2 * self.direction((3, 3), seed)

    def test_energy_is_half_of_the_whole_hinge(self, element):
        x = self.sample(element, 21)
        wide, places = mirror_of(self.X, x, T)
        whole = k.Element(self.whole).energy(wide, places, self.cell4, self.p[:1])[0]
        np.testing.assert_allclose(element.energy(self.X, x, self.cells, self.p)[0], whole / 2, rtol=1e-12)

    def test_forces_do_not_see_a_shift(self, element):
        x = self.sample(element, 22)
        shifted = self.residual(element, self.X, x + np.array([0.3, -0.2, 0.5]))
        np.testing.assert_allclose(shifted, self.residual(element, self.X, x), atol=1e-13)
        np.testing.assert_allclose(shifted.sum(axis=0), 0.0, atol=1e-13)

    def test_a_flat_cell_across_its_mirror_is_at_rest(self, element):
        """And one that is turned about the direction of the mirror."""
        edge = self.X[1] - self.X[0]
        t = np.array([edge[1], -edge[0], 0.0]) / np.linalg.norm(edge)
        p = np.array([0.7, *t])
        for angle in (0.0, 0.8):
            x = np.column_stack([self.X, np.zeros(3)]) @ Rotation.from_rotvec(angle * t).as_matrix().T
            out = np.zeros((3, 3))
            element.residual(self.X, x, self.cells, p, out)
            np.testing.assert_allclose(out, 0.0, atol=1e-14)


class TestMirroredHinge(MirroredCase):
    name, X, whole = "hinge_mirrored_flap3", TRI3, "hinge_flap4"

    def test_hessian_is_constant_and_semidefinite(self, element):
        tangents = [element.tangent_block(self.X, self.sample(element, s), self.p) for s in (1, 2)]
        np.testing.assert_array_equal(*tangents)
        values = np.linalg.eigvalsh(tangents[0])
        assert values[0] > -1e-14 * values[-1]


class TestMirroredNonlinearHinge(MirroredCase):
    name, X, whole = "hinge_nonlinear_mirrored_flap3", TRI3, "hinge_nonlinear_flap4"


@pytest.mark.parametrize("whole", PAIRS)
def test_half_a_sheet_is_half_of_the_symmetric_one(whole):
    """A sheet and its image in the plane x = 0: energy, and the forces on what is not in the mirror."""
    X, cells, _ = unit_box(2, 5)
    rng = np.random.default_rng(2)
    x = np.column_stack([X, 0.3 * np.cos(2 * X[:, 0]) * X[:, 1]]) + 0.01 * rng.uniform(-1, 1, (len(X), 3))
    on_mirror = X[:, 0] < 1e-12
    x[on_mirror, 0] = 0.0
    flip = np.diag([-1.0, 1.0, 1.0])
    number = np.arange(len(X))
    number[~on_mirror] = len(X) + np.arange((~on_mirror).sum())
    wide = np.vstack([X, X[~on_mirror] @ flip[:2, :2]])
    places = np.vstack([x, x[~on_mirror] @ flip])
    all_cells = np.vstack([cells, number[cells][:, ::-1]]).astype(np.int32)

    half = hinges(cells, edges_of_cells(cells, len(X))[1])
    full = hinges(all_cells, edges_of_cells(all_cells, len(wide))[1])
    outer = edges_in_mirror(cells, on_mirror)
    assert len(outer) == 5 and len(full) == 2 * len(half) + len(outer)

    element, mirrored = k.Element(whole), k.Element(PAIRS[whole])
    p, pm = np.array([0.4]), np.array([0.4, 1.0, 0.0, 0.0])
    energy = element.energy(X, x, half, p).sum() + mirrored.energy(X, x, outer, pm).sum()
    np.testing.assert_allclose(2 * energy, element.energy(wide, places, full, p).sum(), rtol=1e-12)

    forces, expected = np.zeros_like(x), np.zeros_like(places)
    element.residual(X, x, half, p, forces)
    mirrored.residual(X, x, outer, pm, forces)
    element.residual(wide, places, full, p, expected)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(forces[~on_mirror], expected[: len(X)][~on_mirror], atol=1e-12 * scale)
    # In the mirror each half has half of the forces along it.
    np.testing.assert_allclose(2 * forces[on_mirror, 1:], expected[: len(X)][on_mirror, 1:], atol=1e-12 * scale)


def edges_in_mirror(cells: np.ndarray, on_mirror: np.ndarray) -> np.ndarray:
    """Nodes (m, 3) int32 of the sides whose ends are both marked, each with the corner on its left."""
    corners = np.array([np.roll(cell, -i) for cell in cells for i in range(3)])
    return corners[on_mirror[corners[:, 0]] & on_mirror[corners[:, 1]]].astype(np.int32)


def strip(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Equilateral triangles of side 1/columns, halved at the sides of a strip of width 1 that runs along x."""
    h, height = 1.0 / columns, np.sqrt(0.75) / columns
    X, start = [], []
    for row in range(rows + 1):
        y = np.arange(columns + 1) * h
        if row % 2:
            y = np.concatenate([[0.0], y[:-1] + h / 2, [1.0]])
        start.append(sum(map(len, X)))
        X.append(np.column_stack([np.full(len(y), row * height), y]))
    cells = []
    for row in range(rows):
        even, odd = (start[row], start[row + 1]) if row % 2 == 0 else (start[row + 1], start[row])
        between = [(even + i, even + i + 1, odd + i + 1) for i in range(columns)]
        between += [(even + i, odd + i + 1, odd + i) for i in range(columns + 1)]
        # Rows that swap their parts swap the sense of the corners too.
        cells += [(a, c, b) for a, b, c in between] if row % 2 == 0 else between
    return np.vstack(X), np.array(cells, dtype=np.int32)


def tip_share(columns: int, slenderness: int, wide: bool = False) -> float:
    """Deflection of a clamped strip's tip under an even load over w L^4/8EI.

    Its sides are free, or in mirrors, as those of a piece of a wide plate.
    """
    X, cells = strip(columns, slenderness * columns)
    clamp = edges_in_mirror(cells, X[:, 0] < 1e-9)
    assert len(clamp) == columns
    D = 2.0
    stiffness = D * HINGE_STIFFNESS["plate" if wide else "strip"]
    blocks = [("hinge_flap4", hinges(cells, edges_of_cells(cells, len(X))[1]), (stiffness,))]
    blocks += [("hinge_mirrored_flap3", clamp, (stiffness, 1.0, 0.0, 0.0))]
    if wide:
        for side in (0.0, 1.0):
            group = edges_in_mirror(cells, abs(X[:, 1] - side) < 1e-9)
            blocks += [("hinge_mirrored_flap3", group, (stiffness, 0.0, 1.0, 0.0))]
    K = np.zeros((len(X), len(X)))
    for name, group, p in blocks:
        element = k.Element(name)
        for cell in group:
            block = element.tangent_block(X[cell], np.zeros((len(cell), 3)), np.array(p))
            K[np.ix_(cell, cell)] += block[2::3, 2::3]
    free = np.flatnonzero(X[:, 0] > 1e-9)
    w = np.linalg.solve(K[np.ix_(free, free)], lumped(X, cells)[free])
    length = X[:, 0].max()
    tip = X[free, 0] > length - 1e-9
    return w[tip].mean() / (length**4 / (8 * D))


def test_a_clamped_plate_between_mirrors_converges_to_the_cantilever():
    errors = [tip_share(columns, 2, wide=True) - 1.0 for columns in (2, 4, 8, 16)]
    assert all(2 * fine < coarse for coarse, fine in itertools.pairwise(errors)) and 0 < errors[-1] < 0.005, errors


def test_a_clamped_strip_with_free_sides_converges_to_the_cantilever():
    """The clamp keeps its end straight across, as a beam's would not: an error of width over length, taken out."""
    errors = [1.0 - (2 * tip_share(columns, 16) - tip_share(columns, 8)) for columns in (2, 4, 6)]
    assert errors[0] > errors[1] > errors[2] and 0 < errors[2] < 0.01, errors
