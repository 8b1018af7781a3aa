"""Bending of planks against beams of Euler and Bernoulli in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.physics.plank_beam import Actions, deflection
from restshape_apps.furniture.physics.plank_bending import PlankBending, plank_bending
from restshape_apps.furniture.pieces import cantilever
from restshape_apps.furniture.shape.planks import Load, Piece, Plane, Plank, feet_near, joints_near, on_floor_without
from restshape_apps.furniture.small_pieces import bench, placed

G = 9.80665


def bent(piece: Piece, plank: int, compliance: Compliance | None = None, case: int = 0) -> PlankBending:
    """Bending of one plank after a test of the piece."""
    furniture = Furniture(piece, compliance)
    furniture.test()
    return plank_bending(furniture, plank, case)


def lifted(found: PlankBending, place: float) -> float:
    """Deflection at a place [m]."""
    return float(np.interp(place, found.along[0].s, found.along[0].deflection))


def test_a_cantilever_sags_by_its_load_and_weight() -> None:
    arm, kilograms = 0.4, 0.3
    furniture = Furniture(cantilever(arm=arm, kilograms=kilograms))
    furniture.test()
    found = plank_bending(furniture, 2)
    EI = 2.5e9 * 0.06 * 0.012**3 / 12
    own = furniture.geometry().mass[2] * G / arm
    assert found.max_deflection == pytest.approx(kilograms * G * arm**3 / (3 * EI) + own * arm**4 / (8 * EI), rel=1e-4)
    moment = kilograms * G * arm + own * arm**2 / 2
    assert found.stress == pytest.approx(moment * 0.006 / (0.06 * 0.012**3 / 12), rel=1e-4)


def test_a_plank_on_two_supports_sags_between_them() -> None:
    # Legs that turn freely: thin, without friction; the board hangs over by 0.1 m at each end.
    furniture = Furniture(bench(0.0, mu=0.0, kilograms=20.0), Compliance(least_overlap=1e-6))
    furniture.test()
    found = plank_bending(furniture, 0)
    EI = 11e9 * 0.3 * 0.02**3 / 12
    w, P, L, a = furniture.geometry().mass[0] * G / 1.2, 20.0 * G, 1.0, 0.1
    expected = 5 * w * L**4 / (384 * EI) + P * L**3 / (48 * EI) - w * a**2 / 2 * L**2 / (8 * EI)
    assert np.abs(np.interp(0.0, found.along[0].s, found.along[0].deflection)) == pytest.approx(expected, rel=1e-3)
    assert np.abs(found.along[0].moment).max() == pytest.approx(P * L / 4 + w * L**2 / 8 - w * a**2 / 2, rel=1e-3)


@pytest.mark.parametrize("place", [-0.58, 0.25, 0.0])
def test_a_hanging_batten_is_no_support(place: float) -> None:
    # Legs that turn freely, 1 m apart; a batten of 50 mm is nailed to the board alone, over an end or between the legs.
    bare, soft = bench(0.0, mu=0.0, kilograms=20.0), Compliance(least_overlap=1e-6)
    batten = Plank.between("batten", (place, 0, 0.5), (place, 0, 0.45), (0, 0.3, 0), 0.002, wood="pine")
    planks = (*bare.planks, batten)
    hung = replace(bare, planks=planks, joints=joints_near(planks))
    assert len(hung.joints) == 3
    one, other = bent(bare, 0, soft), bent(hung, 0, soft)
    EI, L = 11e9 * 0.3 * 0.02**3 / 12, 1.0
    weigh = Furniture(hung, soft)
    weigh.test()
    P, x = weigh.geometry().mass[3] * G, abs(place)
    # By its weight P the middle goes down, or up where it hangs on the overhang.
    b = 0.5 * L - x
    more = P * b * (3 * L**2 - 4 * b**2) / (48 * EI) if b > 0.0 else P * b * L**2 / (16 * EI)
    assert lifted(one, 0.0) - lifted(other, 0.0) == pytest.approx(more, rel=0.01, abs=1e-9)
    assert other.max_deflection == pytest.approx(one.max_deflection, rel=0.005)


def test_a_shelf_between_hangers_is_supported_by_them() -> None:
    # A shelf on two boards that hang from the top: the way to the floor goes past the shelf.
    piece = bench(0.0, kilograms=0.0)
    hangers = [Plank.between(f"hanger {x}", (x, 0, 0.5), (x, 0, 0.3), (0, 0.3, 0), 0.01) for x in (-0.3, 0.3)]
    shelf = Plank.between("shelf", (-0.295, 0, 0.35), (0.295, 0, 0.35), (0, 0.3, 0), 0.01)
    planks = (*piece.planks, *hangers, shelf)
    hung = replace(piece, planks=planks, joints=joints_near(planks), weights=())
    assert on_floor_without(hung, 5) == {0, 1, 2, 3, 4} and on_floor_without(hung, 0) == {1, 2}
    found = bent(hung, 5)
    assert abs(lifted(found, 0.295)) < 1e-9 and abs(lifted(found, -0.295)) < 1e-9 < found.max_deflection


def test_an_apron_under_two_equal_overhangs_counts_as_their_support_though_it_bears_nothing() -> None:
    # Two benches side by side, each with a load between its legs, and an apron under both overhanging ends. This is a
    # limit of the model: supports count as fixed.
    planks, apron = [], Plank.between("apron", (0.75, 0, 0.5), (0.75, 0, 0.45), (0, 0.6, 0), 0.01, wood="pine")
    for y in (-0.2, 0.2):
        planks.append(Plank.between(f"top {y}", (-0.5, y, 0.51), (0.8, y, 0.51), (0, 0.2, 0), 0.02, wood="pine"))
        planks += [Plank.between(f"leg {y} {x}", (x, y, 0), (x, y, 0.5), (0, 0.2, 0), 0.018) for x in (-0.45, 0.3)]
    loads = tuple(Load(f"load {k}", k, (0.0, 0.0, 0.0), (0.0, 0.0, -60.0)) for k in (0, 3))
    piece = Piece(
        (*planks, apron), joints_near((*planks, apron)), feet_near((*planks, apron)), (Plane(mu=0.9),), (), loads
    )
    furniture = Furniture(piece, Compliance(least_overlap=1e-6))
    assert furniture.test().valid and len(piece.joints) == 6
    found = plank_bending(furniture, 0)
    # What the apron puts on the top is half of its weight.
    shear = np.diff(np.interp([0.58, 0.59, 0.61, 0.62], found.along[0].s, found.along[0].moment))[[0, 2]] / 0.01
    own = furniture.geometry().mass[0] * G / 1.3
    step = abs(shear[1] - shear[0]) - own * 0.03
    assert step == pytest.approx(furniture.geometry().mass[6] * G / 2, rel=0.05)
    assert abs(lifted(found, 0.6)) < 1e-9 < 1e-4 < found.max_deflection


def test_an_overhang_sags_under_a_mass_at_its_very_end() -> None:
    # Two supports L apart, a load at the end of an overhang a: P a^2 (L + a) / 3EI at the end, P a L^2 / 16EI up in the
    # middle; the board has no weight.
    P, L, a, EI = 20.0, 1.0, 0.1, 11e9 * 0.3 * 0.02**3 / 12
    board = bench(0.0, mu=0.0, kilograms=0.0)
    hung = (Load("hung", 0, (0.5, 0.0, 0.0), (0.0, 0.0, -P)), Load("still", 0, (0.0, 0.0, 0.0), (0.0, 0.0, -P)))
    one, both = (
        bent(replace(board, weights=loads, gravity=(0.0, 0.0, 0.0)), 0, Compliance(least_overlap=1e-6))
        for loads in (hung[1:], hung)
    )
    end = lifted(both, 0.6) - lifted(one, 0.6)
    middle = lifted(both, 0.0) - lifted(one, 0.0)
    assert end == pytest.approx(-P * a**2 * (L + a) / (3 * EI), rel=1e-3)
    assert middle == pytest.approx(P * a * L**2 / (16 * EI), rel=1e-3)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("place", [-0.6, -0.3, 0.0, 0.6])
def test_a_plank_that_lies_on_the_floor_does_not_bend(place: float, turned: bool) -> None:
    piece = placed(place)
    (plank,) = piece.planks
    if turned:
        plank = replace(plank, axes=plank.axes @ np.diag([1.0, -1.0, -1.0]))
        piece = replace(piece, planks=(plank,), feet=feet_near((plank,)))
    assert [foot.side for foot in piece.feet] == [5 if turned else 4]
    found = bent(piece, 0)
    # On its ends alone it would deflect by 10 mm under 30 kg in the middle, and use a third of its strength.
    between = 30.0 * G * 1.2**3 / (48 * 11e9 * 0.2 * 0.018**3 / 12)
    assert found.max_deflection < 1e-6 * between and found.utilisation < 1e-5


def test_a_foot_lifts_where_the_post_on_it_turns_it() -> None:
    """A board on the floor under a post that is pulled over: it lifts behind, and lies flat ahead of some place."""
    arm, kilograms, half, t = 0.19, 2.0, 0.3, 0.012
    piece = cantilever(arm=arm, kilograms=kilograms, fastener="nail-thesis")
    found = bent(piece, 1)
    EI, per_length = 2.5e9 * 0.2 * t**3 / 12, 700.0 * 0.2 * t * G
    post, beam = 700.0 * 0.2 * t * piece.planks[0].size[0] * G, 700.0 * 0.06 * t * arm * G
    down, couple = post + beam + kilograms * G, kilograms * G * (t / 2 + arm) + beam * (t / 2 + arm / 2)
    # It is flat from c on: all loads behind it have no moment about it.
    c = max(np.roots([per_length / 2, down + per_length * half, per_length * half**2 / 2 - couple]))
    far = half + c
    lift = couple * c * (2 * far - c) / 2 - down * c**2 * (3 * far - c) / 6 - per_length * far**4 / 8
    assert 0.05 < c < 0.25
    assert found.max_deflection == pytest.approx(lift / EI, rel=0.01)
    assert (
        lifted(found, -half) == pytest.approx(found.max_deflection)
        and abs(lifted(found, half)) < 1e-4 * found.max_deflection
    )
    assert np.abs(found.along[0].moment).max() == pytest.approx(couple - per_length * half**2 / 2, rel=1e-3)


def test_the_moment_ends_at_nothing() -> None:
    # Up to the load times what it displaces, which the beam does not know.
    furniture = Furniture(bench(0.3, leg=0.02))
    furniture.test()
    for plank in range(3):
        found = plank_bending(furniture, plank)
        assert abs(found.along[0].moment[-1]) < 1e-6 * 20.0 * G * 0.5


@pytest.mark.parametrize("seed", range(6))
def test_a_floor_pushes_only_and_is_not_passed(seed: int) -> None:
    # What marks a rigid floor that holds nothing: it pushes only, nowhere is the beam below it, and where it is above,
    # nothing pushes.
    random = np.random.default_rng(seed)
    place = np.sort(random.uniform(-0.5, 0.5, 4))
    force, couple = np.array([-40.0, 12.0, -60.0, 8.0]), random.uniform(-3.0, 3.0, 4)
    loads = Actions(place, np.array([0.0, 0.1, 0.0, 0.0]), force, couple, np.zeros(4, dtype=bool), -20.0, 1.2)
    on = loads.on_floor(1.0)
    assert on is not None
    pushed, push = on.place[4:], on.force[4:]
    assert push.min() > 0.0
    assert push.sum() == pytest.approx(-force.sum() + 20.0 * 1.2, rel=1e-5)
    assert push @ pushed == pytest.approx(-(force @ place) - couple.sum(), rel=1e-4, abs=1e-4)
    s = on.stations(201)
    height = deflection(s, on.moments(s) / 100.0, on.constrained())
    assert height.max() > 1e-5
    # Up to what it bends between pushes 15 mm apart.
    assert height.min() > -5e-3 * height.max()
    assert np.abs(np.interp(pushed, s, height)).max() < 2e-3 * height.max()


def test_a_floor_cannot_hold_what_falls() -> None:
    beyond = Actions(np.array([0.7]), np.zeros(1), np.array([5.0]), np.zeros(1), np.zeros(1, dtype=bool), -1.0, 1.2)
    assert beyond.on_floor(1.0) is None


def test_a_beam_that_presses_all_along_on_a_floor_has_nothing_that_bends_it() -> None:
    # A couple of P l / 6 takes the density at one end to nothing; more of it lifts that end, and so does a point load.
    def beam(couple: float, span: float = 1.2) -> Actions:
        none = np.zeros(1)
        return Actions(none, np.array([span]), np.array([-60.0]), np.array([couple]), none > 0.0, 0.0, 1.2)

    assert beam(0.99 * 60.0 * 1.2 / 6).presses(1.0) and beam(-0.99 * 60.0 * 1.2 / 6).presses(1.0)
    assert not beam(1.01 * 60.0 * 1.2 / 6).presses(1.0) and not beam(0.0).presses(-1.0)
    assert not beam(0.0, 0.0).presses(1.0)
    on = beam(6.0).on_floor(1.0)
    assert on is not None and np.abs(on.moments(on.stations(201))).max() < 2e-3 * 60.0 * 1.2
