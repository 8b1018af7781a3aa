"""Planks bend in their plane as well, and across their fibres more easily: against beams in closed form."""

from math import hypot

import pytest
from furniture_scenes import write_edits
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.physics.plank_bending import PlankBending, plank_bending
from restshape_apps.furniture.shape.planks import Load, Piece, Plane, Plank, feet_near, joints_near, weight
from small_scenes import make_replay, rows_of

G, LONG, DEEP, T = 9.80665, 1.0, 0.06, 0.02
PINE = wood("pine")


def bent(piece: Piece, plank: int, case: int = 0) -> PlankBending:
    """Bending of a plank of a piece with thin joints."""
    furniture = Furniture(piece, Compliance(least_overlap=1e-6))
    furniture.test()
    return plank_bending(furniture, plank, case)


def rail(force: tuple[float, float, float], turned: bool = False) -> Piece:
    """A rail on edge between two thin sides, with a force in the middle of its upper edge; `turned`: drawn upwards."""
    x = LONG / 2
    sides = [Plank.between(f"{s * x:g}", (s * x, 0, 0), (s * x, 0, 0.5), (0, 0.2, 0), 1e-4) for s in (-1, 1)]
    if turned:
        on_edge = Plank.between("rail", (0, 0, 0.3 - DEEP / 2), (0, 0, 0.3 + DEEP / 2), (LONG, 0, 0), T, wood="pine")
    else:
        on_edge = Plank.between("rail", (-x, 0, 0.3), (x, 0, 0.3), (0, 0, DEEP), T, wood="pine")
    planks = (*sides, on_edge)
    load = Load("load", 2, (0.5, 0.0, 0.0) if turned else (0.0, 0.5, 0.0), force)
    return Piece(planks, joints_near(planks), feet_near(planks), (Plane(mu=0.9),), (load,), gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize("turned", [False, True])
def test_a_rail_on_edge_sags_as_a_beam_of_its_depth(turned: bool) -> None:
    force = 500.0
    found = bent(rail((0.0, 0.0, -force), turned), 2)
    # Drawn upwards, the rail has its fibres upright.
    E, bears = (PINE.E_across, PINE.tension_across) if turned else (PINE.E, PINE.bending)
    assert found.max_deflection == pytest.approx(force * LONG**3 / (48 * E * T * DEEP**3 / 12), rel=1e-3)
    assert found.stress == pytest.approx(force * LONG / 4 / (T * DEEP**2 / 6), rel=1e-3)
    assert found.utilisation == pytest.approx(found.stress / bears) and found.across is turned


def test_stresses_of_both_ways_add_up_at_the_corners_and_deflections_as_vectors() -> None:
    down, aside = 300.0, 40.0
    found = bent(rail((0.0, aside, -down)), 2)
    moment = LONG / 4
    # The force aside acts on the edge: its couple twists the rail alone.
    assert found.stress == pytest.approx(moment * (down / (T * DEEP**2 / 6) + aside / (DEEP * T**2 / 6)), rel=2e-3)
    ways = down / (T * DEEP**3 / 12), aside / (DEEP * T**3 / 12)
    assert found.max_deflection == pytest.approx(LONG**3 / (48 * PINE.E) * hypot(*ways), rel=2e-3)


@pytest.mark.parametrize("along", [False, True])
def test_a_shelf_on_one_edge_bends_along_or_across_its_fibres(along: bool) -> None:
    depth, long = 0.3, 0.5
    back = Plank.between("back", (-T / 2, 0, 0), (-T / 2, 0, 0.6), (0, long + 0.2, 0), T, wood="pine")
    if along:
        shelf = Plank.between("shelf", (0, 0, 0.3), (depth, 0, 0.3), (0, long, 0), T, wood="pine")
    else:
        shelf = Plank.between("shelf", (depth / 2, -0.25, 0.3), (depth / 2, 0.25, 0.3), (depth, 0, 0), T, wood="pine")
    load = Load("load", 1, (0.5, 0.0, 0.0) if along else (0.0, 0.5, 0.0), (0.0, 0.0, -10.0))
    planks = (back, shelf)
    found = bent(Piece(planks, joints_near(planks), feet_near(planks), weights=(load,), gravity=(0.0, 0.0, 0.0)), 1)
    E, bears = (PINE.E, PINE.bending) if along else (PINE.E_across, PINE.tension_across)
    assert found.max_deflection == pytest.approx(10.0 * depth**3 / (3 * E * long * T**3 / 12), rel=1e-3)
    assert found.utilisation == pytest.approx(10.0 * depth / (long * T**2 / 6) / bears, rel=1e-3)
    assert found.across is not along


def test_a_panel_bends_alike_along_both_sides() -> None:
    mdf = wood("mdf")
    assert (mdf.modulus_across, mdf.strength_across) == (mdf.E, mdf.bending)


def test_a_board_on_the_floor_does_not_bend_in_its_plane() -> None:
    lying = Plank.between("lying", (-0.5, 0, T / 2), (0.5, 0, T / 2), (0, 0.05, 0), T, wood="pine")
    push = Load("push", 0, (0.0, 0.5, 0.0), (0.0, 1.0, 0.0))
    planks = (lying, Plank.between("post", (0, 0, T), (0, 0, 0.3), (0, 0.05, 0), T))
    piece = Piece(planks, joints_near(planks), feet_near(planks), (Plane(),), (weight("m", 1, 5.0, (0.5, 0.0, 0.0)),))
    found = bent(Piece(piece.planks, piece.joints, piece.feet, piece.planes, piece.weights, (push,)), 0, case=1)
    assert not found.on_edge.moment.any() and not found.on_edge.deflection.any()


def test_a_rail_that_breaks_on_edge_makes_a_piece_uncertain(tmp_path) -> None:
    path = tmp_path / "rail.toml"
    path.write_text("""
format = "restshape-scene"
version = 1
app = "furniture"
wood = { name = "oak", thickness = "20 mm" }
fastener = { name = "dowel", spacing = "30 mm" }
weights = { hammock = { on = "rail", mass = "100 kg", at = [0, 0.5, 0] } }
effects = { gravity = {}, bending = {} }
[planks]
left = { from = [-0.6, 0, 0], to = [-0.6, 0, 0.5], width = [0, 0.4, 0] }
right = { from = [0.6, 0, 0], to = [0.6, 0, 0.5], width = [0, 0.4, 0] }
rail = { from = [-0.59, 0, 0.4], to = [0.59, 0, 0.4], width = [0, 0, 0.04] }
shelf = { from = [-0.59, 0, 0.1], to = [0.59, 0, 0.1], width = [0, 0.4, 0] }
""")
    row = rows_of(make_replay(path, write_edits(tmp_path), "auto"))[-1]
    assert row["constraint_status"] == "uncertain"
    moment, W = 100 * G * 1.18 / 4, 0.02 * 0.04**2 / 6
    assert row["bending_utilisation"] == pytest.approx(moment / W / wood("oak").bending, rel=0.03)
    assert row["deflection"] == pytest.approx(moment * 1.18**2 / (12 * wood("oak").E * W * 0.02), rel=0.03)
