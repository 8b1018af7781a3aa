"""Numbers of heat at edges of a fluid: Nusselt numbers where a heat flux is given, and bulk temperatures."""

import numpy as np
import pytest
from flow_scenes import CHANNEL
from restshape_studies.stability.scenery import block, drag, make_replay, set_value, write_scene, write_script
from restshape_verification.flow.heated_scenes import HEAD
from restshape_verification.flow.scenes import STEADY
from thermal_scenes import solved

from restshape.errors import UserError

PLACE = f"""{HEAD}{block(2.0, 1.0)}[fluid]
rho = 1
mu = 1
conductivity = 0.5
heat_capacity = 1
reference = "300 K"
[mesh]
size = 0.25
"""
PLATE = f"""{PLACE}
[boundary.heated]
on = "left"
wall = true
heat_flux = "7 W/m^2"
[boundary.cold]
on = "right"
wall = true
temperature = "300 K"
[effects]
heat = {{}}
[quantities]
"""
COUETTE = f"""{PLACE}
[boundary.belt]
on = "top"
velocity = [1, 0]
temperature = "301 K"
[boundary.floor]
on = "bottom"
wall = true
temperature = "300 K"
[boundary.inlet]
on = "left"
velocity = ["y", 0]
temperature = "300 + y"
[boundary.outlet]
on = "right"
outflow = true
[effects]
flow = {{ steady = true }}
convection = {{}}
heat = {{}}
[quantities]
enters = {{ bulk_temperature = true, at = "left" }}
leaves = {{ bulk_temperature = true, at = "right" }}
"""


def test_a_nusselt_number_of_a_given_flux_is_over_the_difference_that_it_makes(tmp_path):
    """By conduction alone q L / k is the difference to the cold wall 2 m away, and twice that of the mean to it."""
    text = PLATE + 'nu = { nusselt = { length = 2, against = "right" }, at = "left" }\n'
    row = solved(tmp_path, text + 'mean = { nusselt = { length = 2, against = "all" }, at = "left" }\n').row
    assert row["q_nu"] == pytest.approx(1.0, rel=1e-6) and row["q_mean"] == pytest.approx(2.0, rel=1e-6)


def test_a_given_flux_over_a_given_difference_is_refused_with_what_to_do(tmp_path):
    text = PLATE + 'nu = { nusselt = { length = 2, difference = 28 }, at = "left" }\n'
    with pytest.raises(UserError, match="heat flux at 'left' is given") as caught:
        solved(tmp_path, text)
    assert 'against = "all"' in caught.value.do and "quantities.nu.nusselt" in caught.value.where
    plain = text.replace('heat_flux = "7 W/m^2"', 'temperature = "310 K"')
    script = write_script(tmp_path, set_value("boundary.heated", {"on": "left", "wall": True, "heat_flux": 3}))
    first, *_, last = [dict(row) for row in make_replay(write_scene(tmp_path, plain), script).frames()]
    assert not first["refused"] and "heat flux at 'left' is given" in last["refused"]


def test_a_bulk_temperature_is_weighted_by_the_velocity(tmp_path):
    """Couette flow u = y with T = 300 + y: the integral of u T over that of u is 300 + 2/3."""
    row = solved(tmp_path, COUETTE, "solve.tolerance=1e-10").row
    assert row["q_enters"] == pytest.approx(300 + 2 / 3, abs=1e-9)
    assert row["q_leaves"] == pytest.approx(300 + 2 / 3, abs=1e-6)
    wall = COUETTE.replace('bulk_temperature = true, at = "left"', 'bulk_temperature = true, at = "bottom"')
    with pytest.raises(UserError, match="no fluid passes 'bottom'"):
        solved(tmp_path, wall)


@pytest.mark.slow
@pytest.mark.parametrize("way", [-0.04, 0.04])
@pytest.mark.parametrize("scheme", ["bdf2", "backward_euler"])
def test_a_wall_that_is_dragged_gives_off_what_it_conducts(tmp_path, way, scheme):
    """A warm wall is dragged through fluid that its warmth has hardly entered, by a side of a cell in four frames.

    Fields that nodes keep and those at their new places (remap) give the same heat, to within a third; heat
    that the wall sweeps would be six times that, or against it, and of the other sign in the frame after the drag.
    """
    text = f"""{HEAD}{block(0.5, 0.4)}
[fluid]
rho = 1
mu = 0.002
conductivity = 0.002
heat_capacity = 1
[boundary.warm]
on = "left"
wall = true
temperature = "300.5 K"
[boundary.cold]
on = "right"
wall = true
temperature = "299.5 K"
[effects]
flow = {{ time_step = 0.02, scheme = "{scheme}", carry = "CARRY" }}
heat = {{ initial = 300 }}
[mesh]
size = 0.04
[quantities]
gives = {{ heat_flow = true, at = "left" }}
"""
    events = [{"do": "idle", "frames": 40}, *drag("left", (0.0, 0.2), [(way * k / 4, 0.2) for k in range(1, 5)])]
    events += [{"do": "idle", "frames": 3}]
    found = []
    for carry in ("ale", "remap"):
        scene = write_scene(tmp_path, text.replace("CARRY", carry))
        rows = [dict(row) for row in make_replay(scene, write_script(tmp_path, events)).frames()][41:]
        assert not any(row["refused"] for row in rows)
        found.append(-np.array([row["q_gives"] for row in rows]))
    assert min(one.min() for one in found) > 0.0
    moving = slice(1, 6)
    np.testing.assert_allclose(found[0][moving], found[1][moving], rtol=0.35, atol=2e-4)


@pytest.mark.parametrize("order", [1, 2])
def test_edges_that_meet_share_the_heat_of_their_corner(tmp_path, order):
    """T = 300 K + x y (K/m^2) is harmonic: half a watt passes through each side of a square of 1 m."""
    sides = ("left", "right", "bottom", "top")
    supports = "".join(f'[supports.{on}]\non = "{on}"\nfix = {{ temperature = "300 + x*y" }}\n' for on in sides)
    quantities = "".join(f'{on} = {{ heat_flow = true, at = "{on}" }}\n' for on in sides)
    text = f"{HEAD}{block()}[material.m]\nconductivity = 1\n{supports}[mesh]\nsize = 0.2\norder = {order}\n"
    row = solved(tmp_path, f"{text}[quantities]\n{quantities}").row
    assert [row[f"q_{on}"] for on in sides] == pytest.approx([0.5, -0.5, 0.5, -0.5], rel=2e-3)
    assert sum(row[f"q_{on}"] for on in sides) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("cut", [0.2, 0.02])
def test_no_heat_is_lost_beside_an_edge_of_one_facet(tmp_path, cut):
    """A corner is cut off: what passes through all five sides of a square is nothing, as no heat is made inside."""
    sides = ("bottom", "right", "cut", "top", "left")
    places = [(0, 0), (1, 0), (1, 1 - cut), (1 - cut, 1), (0, 1)]
    vertices = ", ".join(f"{name} = [{x}, {y}]" for name, (x, y) in zip("abcde", places))
    edges = "".join(f'{on} = {{ line = ["{a}", "{b}"] }}\n' for on, a, b in zip(sides, "abcde", "bcdea"))
    shape = f"[shape]\noutline = {list(sides)}\nvertices = {{ {vertices} }}\n[shape.edges]\n{edges}"
    supports = "".join(f'[supports.{on}]\non = "{on}"\nfix = {{ temperature = "300 + x*y + x" }}\n' for on in sides)
    quantities = "".join(f'{on} = {{ heat_flow = true, at = "{on}" }}\n' for on in sides)
    text = f"{HEAD}{shape}[material.m]\nconductivity = 1\n{supports}[mesh]\nsize = 0.3\norder = 1\n"
    frame = solved(tmp_path, f"{text}[quantities]\n{quantities}")
    assert len(frame.analysis.space.facets_of("cut")) == 1
    found = [frame.row[f"q_{on}"] for on in sides]
    half = 0.5 * (1 - cut) ** 2
    exact = [0.5, cut - 1 - half, (cut - 3) * cut, -half, 1.5]
    assert found == pytest.approx(exact, abs=0.02)
    assert sum(found) == pytest.approx(0.0, abs=1e-9)


def test_a_wall_beside_an_inlet_has_its_own_drag(tmp_path):
    """Of Poiseuille's flow: the pressure of the inlet, 8 mu u L / H^2 = 2.4 Pa, is none of the wall's friction."""
    quantities = '[quantities]\nwall = { drag = true, at = "bottom" }\ninlet = { drag = true, at = "inlet" }\n'
    row = solved(tmp_path, f"{CHANNEL}{STEADY}[mesh]\nsize = 0.1\n{quantities}").row
    assert (row["q_wall"], row["q_inlet"]) == pytest.approx((1.2, -2.4), rel=0.015)
