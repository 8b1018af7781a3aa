"""Planks bend between their supports, whichever of their sides is longer: against beams, and a plate by Ritz."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.physics.plank_bending import PlankBending, plank_bending
from restshape_apps.furniture.shape.planks import (
    Foot,
    Load,
    Piece,
    Plane,
    Plank,
    feet_near,
    joints_near,
    weight,
)
from restshape_apps.furniture.small_pieces import nailed_along

G, T, E = 9.80665, 0.02, 2.5e9
SOFT = Compliance(least_overlap=1e-6)
"""Of joints of thin legs, 1 mm long."""


def bent(piece: Piece, plank: str) -> tuple[PlankBending, float]:
    """Bending of a plank under the weights, and its weight [N]."""
    furniture = Furniture(piece, SOFT)
    furniture.test()
    number = [one.name for one in piece.planks].index(plank)
    return plank_bending(furniture, number), float(furniture.geometry().mass[number] * G)


def ledge(depth: float, long: float, turned: bool = False, kilograms: float = 5.0) -> Piece:
    """A shelf whose edge of a length is nailed to a fixed board, with a mass in the middle of its free edge."""
    back = Plank.between("back", (-T / 2, 0, 0), (-T / 2, 0, 0.6), (0, long + 0.2, 0), T)
    if turned:
        shelf = Plank.between("shelf", (depth / 2, -long / 2, 0.3), (depth / 2, long / 2, 0.3), (depth, 0, 0), T)
        place = (0.0, 0.5, 0.0)
    else:
        shelf = Plank.between("shelf", (0, 0, 0.3), (depth, 0, 0.3), (0, long, 0), T)
        place = (0.5, 0.0, 0.0)
    planks = (back, shelf)
    planes = (Plane(), Plane((0.0, 0.0, 0.6), (0.0, 0.0, -1.0)))
    return Piece(
        planks, joints_near(planks), (Foot(0, 0, 0), Foot(0, 1, 1)), planes, (weight("mass", 1, kilograms, place),)
    )


def between(depth: float, kilograms: float = 20.0) -> Piece:
    """A board on two thin boards without friction, 1 m apart and as wide as it is, with a mass in its middle."""
    top = Plank.between("top", (-0.5, 0, 0.51), (0.5, 0, 0.51), (0, depth, 0), T)
    sides = [Plank.between(f"{x:g}", (x, 0, 0), (x, 0, 0.5), (0, depth, 0), 1e-4) for x in (-0.5, 0.5)]
    planks = (top, *sides)
    put = weight("mass", 0, kilograms, (0.0, 0.0, 0.0))
    return Piece(planks, joints_near(planks), feet_near(planks), (Plane(mu=0.0),), (put,))


def on_posts(length: float, width: float, wood: str = "mdf") -> Piece:
    """A board that lies on four thin posts at its corners."""
    top = Plank.between("top", (-length / 2, 0, 0.51), (length / 2, 0, 0.51), (0, width, 0), T, wood=wood)
    places = [(sx * (length / 2 - 1e-3), sy * (width / 2 - 1e-3)) for sx in (-1, 1) for sy in (-1, 1)]
    posts = [Plank.between(f"post {k}", (x, y, 0), (x, y, 0.5), (0, 1e-3, 0), 1e-4) for k, (x, y) in enumerate(places)]
    planks = (top, *posts)
    return Piece(planks, joints_near(planks), feet_near(planks), (Plane(mu=0.0),))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("depth", [0.1, 0.3, 0.499, 0.501, 0.8, 1.5])
def test_a_shelf_on_one_edge_sags_away_from_it(depth: float, turned: bool) -> None:
    long, P = 0.5, 5.0 * G
    found, weighs = bent(ledge(depth, long, turned), "shelf")
    EI = E * long * T**3 / 12
    assert found.max_deflection == pytest.approx(
        P * depth**3 / (3 * EI) + weighs / depth * depth**4 / (8 * EI), rel=1e-3
    )
    assert found.stress == pytest.approx((P + weighs / 2) * depth / (long * T**2 / 6), rel=1e-3)


def test_a_shelf_that_is_nailed_along_its_long_side_bends_across_it() -> None:
    EI, b, P = E * 1.0 * 0.012**3 / 12, 0.2, 5.0 * G
    found, weighs = bent(nailed_along(5.0), "shelf")
    # The mass lies on half of the way from the edge, and turns the rest with it.
    expected = P * b**3 * (1 / 24 + 1 / 16) / EI + weighs * b**3 / (8 * EI)
    assert found.max_deflection == pytest.approx(expected, rel=1e-3)
    assert np.abs(found.along[1].deflection).max() < 1e-9 * expected


@pytest.mark.parametrize("depth", [0.2, 0.6, 0.999, 1.001, 1.6, 3.0])
def test_a_board_between_two_edges_sags_between_them(depth: float) -> None:
    found, weighs = bent(between(depth), "top")
    EI, P = E * depth * T**3 / 12, 20.0 * G
    assert found.max_deflection == pytest.approx(5 * weighs / (384 * EI) + P / (48 * EI), rel=2e-3)
    assert found.stress == pytest.approx((P / 4 + weighs / 8) / (depth * T**2 / 6), rel=2e-3)


def test_an_upright_board_on_its_long_edge_bends_away_from_the_floor() -> None:
    plank = Plank.between("edge", (-0.6, 0, 0.1), (0.6, 0, 0.1), (0, 0, 0.2), 0.018)
    push = Load("push", 0, (0.0, 0.5, 0.0), (0.0, 0.2, 0.0))
    furniture = Furniture(Piece((plank,), (), feet_near((plank,)), (Plane(),), (), (push,)))
    furniture.test()
    EI = E * 1.2 * 0.018**3 / 12
    assert plank_bending(furniture, 0, case=1).max_deflection == pytest.approx(0.2 * 0.2**3 / (3 * EI), rel=1e-2)


def niche(depth: float, wide: float) -> Piece:
    """A shelf between two sides and before a back, with a mass in the middle of its free edge."""
    shelf = Plank.between("shelf", (-wide / 2, 0, 0.3), (wide / 2, 0, 0.3), (0, depth, 0), T)
    x, y = wide / 2 + T / 2, depth / 2 + T / 2
    sides = [Plank.between(f"{s * x:g}", (s * x, 0, 0), (s * x, 0, 0.6), (0, depth, 0), T) for s in (-1, 1)]
    back = Plank.between("back", (0, y, 0), (0, y, 0.6), (wide + 2 * T, 0, 0), T)
    planks = (shelf, *sides, back)
    return Piece(planks, joints_near(planks), feet_near(planks), weights=(weight("m", 0, 20.0, (0.0, -0.5, 0.0)),))


@pytest.mark.parametrize("depth", [0.1, 0.2, 0.4, 0.6, 0.8, 2.4])
def test_a_shelf_before_a_back_sags_as_from_it_or_as_between_its_sides(depth: float) -> None:
    wide, P = 0.8, 20.0 * G
    found, weighs = bent(niche(depth, wide), "shelf")
    EI = E * T**3 / 12
    back = (P / 3 + weighs / 8) * depth**3 / (EI * wide)
    sides = (P / 48 + 5 * weighs / 384) * wide**3 / (EI * depth)
    # The sides turn the ends of the shelf a little.
    assert found.max_deflection == pytest.approx(min(back, sides), rel=1e-4 if back < sides else 0.05)


@pytest.mark.parametrize("poisson", [0.0, 0.3])
@pytest.mark.parametrize("ratio", [0.25, 0.5, 0.98, 1.02, 2.0, 4.0])
def test_a_board_on_four_corners_bends_along_both_sides(ratio: float, poisson: float) -> None:
    length, width = 0.8, 0.8 * ratio
    found, weighs = bent(on_posts(length, width), "top")
    plate = plate_on_corners(length, width, weighs / (length * width), poisson)
    # The sum of two beams is within 12 % of a plate.
    assert found.max_deflection == pytest.approx(plate, rel=0.12)


@pytest.mark.parametrize("ratio", [0.25, 0.5, 1.0, 2.0])
def test_a_board_of_pine_on_four_corners_bends_as_an_orthotropic_plate(ratio: float) -> None:
    length, width = 0.8, 0.8 * ratio
    found, weighs = bent(on_posts(length, width, "pine"), "top")
    pine = wood("pine")
    plate = plate_on_corners(length, width, weighs / (length * width), fibres=(pine.E, pine.E_across, 0.69e9))
    assert found.max_deflection == pytest.approx(plate, rel=0.12)


def plate_on_corners(
    length: float,
    width: float,
    pressure: float,
    poisson: float = 0.0,
    fibres: tuple[float, float, float] = (E, E, E / 2),
) -> float:
    """Sag of the middle of a Kirchhoff plate on its corners, by Ritz with even polynomials.

    `fibres` has E along x, E along y and the shear modulus without Poisson's ratio [Pa].
    """
    D, (along, across, shear) = T**3 / 12 / (1.0 - poisson**2), fibres
    x, weights = np.polynomial.legendre.leggauss(16)
    powers = [(i, j) for i in range(0, 11, 2) for j in range(0, 11, 2) if i + j]

    def monomial(n: int, order: int) -> np.ndarray:
        return np.polyval(np.polyder(np.eye(1, n + 1)[0], order), x) if order else x**n

    a, b = length / 2, width / 2
    areas = np.outer(weights, weights).ravel() * a * b
    xx, yy, xy, w = (
        np.array([np.outer(monomial(i, m) / a**m, monomial(j, n) / b**n).ravel() for i, j in powers])
        for m, n in ((2, 0), (0, 2), (1, 1), (0, 0))
    )
    both = xx + yy
    K = D * E * (poisson * (both * areas) @ both.T)
    moduli = ((along, xx), (across, yy), (4.0 * shear, xy))
    K += D * (1.0 - poisson) * sum(one * (way * areas) @ way.T for one, way in moduli)
    # From the corners, where each monomial is 1, to the middle, where it is 0.
    return float(np.linalg.solve(K, pressure * ((1.0 - w) * areas).sum(axis=1)).sum())
