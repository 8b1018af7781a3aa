"""Strength of fasteners against the formulas of their sources, worked by hand."""

from math import pi, sqrt

import pytest
from restshape_apps.furniture.physics.fasteners import FASTENERS, WOODS, fastener, johansen, wood
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.planks import Piece, Plank, feet_near, joints_near

from restshape.errors import UserError

INCH, POUND = 0.0254, 4.4482216


def pull(name: str, into: str, through: str, thickness: float, edge: float = 0.018) -> float:
    """The pull [N] that one bears through a wood of that thickness [m] into the end of another."""
    return fastener(name).pull_strength(wood(into), wood(through), thickness, edge)


def shear(name: str, into: str, through: str, thickness: float) -> float:
    """The shear [N] that one bears there."""
    return fastener(name).shear_strength(wood(into), wood(through), thickness)


def test_the_nail_of_the_thesis() -> None:
    assert pull("nail-thesis", "mdf", "mdf", 0.012, 0.012) == pytest.approx(700.0)
    assert shear("nail-thesis", "mdf", "mdf", 0.012) == 190.0


def test_the_nail_of_the_experiment() -> None:
    # 1.86 N m with three nails and a lever of 6 mm.
    assert 3 * 0.006 * pull("nail-experiment", "mdf", "mdf", 0.012, 0.012) == pytest.approx(1.86, rel=0.01)


@pytest.mark.parametrize(
    ("name", "factor", "power", "end", "into", "through", "thickness"),
    [("nail", 7850.0, 2.5, 0.5, "pine", "oak", 0.018), ("screw", 15700.0, 2.0, 0.75, "pine", "oak", 0.024)],
)
def test_withdrawal_from_end_grain(name, factor, power, end, into, through, thickness) -> None:
    # Wood Handbook, chapter 8, in inches and pounds: 7850 G^(5/2) D L for nails, of which half to three quarters are
    # left in end grain, and 15,700 G^2 D L for wood screws, of which 75 % are.
    kind, gravity = fastener(name), {"pine": 0.38}[into]
    depth = (kind.length - thickness) / INCH
    by_hand = end * factor * gravity**power * kind.diameter / INCH * depth * POUND
    assert pull(name, into, through, thickness) == pytest.approx(by_hand, rel=2e-3)


def test_withdrawal_of_a_screw_from_the_edge_of_a_panel() -> None:
    # Wood Handbook, chapter 8, in inches and pounds: 2055 D^(1/2) (L - D/3)^(5/4) G^2, particleboard, edges. Screws go
    # 12 mm into it here, so that they draw before their heads pass through what they hold, oak.
    diameter, depth = 4e-3 / INCH, 12e-3 / INCH
    by_hand = 2055.0 * sqrt(diameter) * (depth - diameter / 3) ** 1.25 * 0.65**2 * POUND
    assert by_hand == pytest.approx(520.0, rel=0.01)
    assert pull("screw", "mdf", "oak", 0.028) == pytest.approx(by_hand, rel=2e-3)


HEADS = [
    # EN 1995-1-1 (8.26): 70e-6 rho^2 d_h^2, with 350 and 530 kg/m^3.
    ("screw", "oak", "pine", 0.012, 70e-6 * 350**2 * 8**2),
    ("screw", "oak", "oak", 0.012, 70e-6 * 530**2 * 8**2),
    ("nail", "pine", "pine", 0.012, 70e-6 * 350**2 * 4**2),
    # ETA-11/0190: 8 N/mm^2 in panels of 12 to 20 mm, 10 N/mm^2 beyond, no more than 400 N below.
    ("screw", "pine", "mdf", 0.012, 8.0 * 8**2),
    ("screw", "oak", "mdf", 0.022, 10.0 * 8**2),
    ("screw", "pine", "mdf", 0.010, 400.0),
    ("screw", "mdf", "mdf", 0.018, 8.0 * 8**2),
]


@pytest.mark.parametrize(("name", "into", "through", "thickness", "newtons"), HEADS)
def test_heads_pass_through_before_the_rest_is_drawn(name, into, through, thickness, newtons) -> None:
    assert pull(name, into, through, thickness) == pytest.approx(newtons, rel=1e-6)


def test_a_glued_dowel_leaves_the_plank_that_holds_less_of_it() -> None:
    # Class C24: 4 MPa along the grain; class D30: 3.9 MPa; MDF: the least that Uysal found in any board.
    assert pull("dowel", "pine", "pine", 0.012) == pytest.approx(pi * 8 * 12 * 4.0)
    assert pull("dowel", "pine", "pine", 0.038) == pytest.approx(pi * 8 * 12 * 4.0)
    assert pull("dowel", "oak", "pine", 0.030) == pytest.approx(pi * 8 * 20 * 3.9)
    assert pull("dowel", "mdf", "mdf", 0.018) == pytest.approx(pi * 8 * 18 * 2.82)


SHEARS = [
    # d = 2.2: (8.15) 0.082 x 350 x 2.2^-0.3 = 22.65 N/mm^2, (8.14) 0.3 x 600 x 2.2^2.6 = 1398 N mm; two hinges, (8.6 f)
    # 1.15 sqrt(2 x 1398 x 22.65 x 2.2) = 429.2 N; one hinge (8.6 d), with t = 18 mm and equal woods,
    # 1.05 x 22.65 x 18 x 2.2 / 3 x (sqrt(4 + 12 x 1398 / (22.65 x 2.2 x 18^2)) - 1) = 390.8 N.
    ("nail", "pine", "pine", 0.018, 0.67 * 390.8),
    # d = 1.1 x 2.6 = 2.86: 20.94 N/mm^2, 0.3 x 400 x 2.86^2.6 = 1844 N mm, (8.6 d)
    # 1.05 x 20.94 x 18 x 2.86 / 3 x (sqrt(4 + 12 x 1844 / (20.94 x 2.86 x 18^2)) - 1) = 478.1 N.
    ("screw", "pine", "pine", 0.018, 0.67 * 478.1),
    # d = 8: (8.32) 0.082 x 0.92 x 350 = 26.40 N/mm^2, 40 x pi 8^3 / 32 = 2011 N mm, (8.6 f): 1059.9 N.
    ("dowel", "pine", "pine", 0.018, 0.67 * 1059.9),
    # In the edge of MDF: the thesis's nail.
    ("screw", "mdf", "mdf", 0.018, 190.0),
    ("dowel", "mdf", "pine", 0.018, 190.0),
]


@pytest.mark.parametrize(("name", "into", "through", "thickness", "newtons"), SHEARS)
def test_shear_by_hand(name, into, through, thickness, newtons) -> None:
    assert shear(name, into, through, thickness) == pytest.approx(newtons, rel=2e-3)


def test_shear_through_a_panel() -> None:
    # d = 2.2: (8.22) 65 x 2.2^-0.7 x 12^0.1 = 47.99 N/mm^2 at the head, b = 22.65 / 47.99, (8.6 d).
    b, slender = 22.65 / 47.99, 1398 / (47.99 * 2.2 * 12**2)
    hinge = sqrt(2 * b * (1 + b) + 4 * b * (2 + b) * slender) - b
    assert shear("nail", "pine", "mdf", 0.012) == pytest.approx(
        0.67 * 1.05 * 47.99 * 12 * 2.2 / (2 + b) * hinge, rel=2e-3
    )
    # d = 8: (8.37) 50 x 8^-0.6 x 18^0.2 = 25.60 N/mm^2, b = 26.40 / 25.60.
    b = 26.40 / 25.60
    two_hinges = 1.15 * sqrt(2 * b / (1 + b)) * sqrt(2 * 2011 * 25.60 * 8)
    assert shear("dowel", "pine", "mdf", 0.018) == pytest.approx(0.67 * two_hinges, rel=2e-3)


def test_johansen_with_equal_members() -> None:
    f, d, moment = 20e6, 0.003, 3.0
    # Long members: two hinges, sqrt(2 M f d) times 1.15. Short ones: the wood gives way at (sqrt(2) - 1) f t d.
    assert johansen(f, f, 1.0, 1.0, d, moment) == pytest.approx(1.15 * sqrt(2 * moment * f * d))
    assert johansen(f, f, 1e-3, 1e-3, d, moment) == pytest.approx((sqrt(2) - 1) * f * 1e-3 * d, rel=1e-6)
    assert johansen(f, f, 1e-4, 1.0, d, moment) == pytest.approx(f * 1e-4 * d, rel=1e-6)


def test_every_entry_names_its_source() -> None:
    assert all(len(entry.source) > 10 for entry in (*FASTENERS.values(), *WOODS.values()))


def corner(fastening: str, thickness: float, board: str = "mdf") -> Piece:
    """A board that stands on its end under another."""
    post = Plank.between("post", (0, 0, 0), (0, 0, 0.3), (0, 0.2, 0), thickness, wood=board)
    top = Plank.between(
        "top", (-0.2, 0, 0.3 + thickness / 2), (0.2, 0, 0.3 + thickness / 2), (0, 0.2, 0), thickness, wood="pine"
    )
    return Piece((post, top), joints_near((post, top), fastener=fastening), feet_near((post,)))


def test_what_nobody_has_tested_in_edges_of_mdf_is_refused() -> None:
    with pytest.raises(UserError, match="no strength of nail in the edge of mdf is known"):
        Furniture(corner("nail", 0.018))
    with pytest.raises(UserError, match="no strength of screw is known in an edge of 12 mm of mdf, but from 15 mm on"):
        Furniture(corner("screw", 0.012))
    with pytest.raises(UserError, match="no strength of dowel is known in an edge of 12 mm of mdf, but from 16 mm on"):
        Furniture(corner("dowel", 0.012))
    for fastening, thickness, board in (
        ("nail", 0.018, "pine"),
        ("screw", 0.015, "mdf"),
        ("screw", 0.012, "pine"),
        ("dowel", 0.016, "mdf"),
        ("nail-thesis", 0.012, "mdf"),
    ):
        assert len(Furniture(corner(fastening, thickness, board)).strength) == 1


def test_unknown_names_say_what_there_is() -> None:
    with pytest.raises(UserError, match="nail-thesis"):
        fastener("rivet")
    with pytest.raises(UserError, match="mdf"):
        wood("balsa")
