"""What slides is distinguished from what falls, by hand; weights without a place lie on top."""

import numpy as np
import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.physics.furniture import Furniture, enough_mass, falling_cases
from restshape_apps.furniture.physics.plank_findings import FALLS
from restshape_apps.furniture.physics.plank_phrases import rounded_up
from restshape_apps.furniture.physics.sliding import CLOSE, on_floor
from restshape_apps.furniture.shape.plank_scene import piece_of, top_of
from restshape_apps.furniture.shape.planks import Plank
from restshape_apps.furniture.small_pieces import block
from restshape_apps.furniture.tests.furniture_scenes import BENCH, write_bench

from restshape.scene.load import load_scene

PUSH = """
[pushes.shove]
on = "top"
force = [FORCE, 0, 0]
[effects.push]
"""


def bench(tmp_path, force: float, friction: float) -> Furniture:
    text = BENCH + PUSH.replace("FORCE", str(force)) + f"\n[floor]\nfriction = {friction}\n"
    furniture = Furniture(Furniture(piece_of(load_scene(write_bench(tmp_path, text)))).moved())
    furniture.test()
    return furniture


@pytest.mark.parametrize(
    ("share", "friction", "words"),
    [
        # The friction needed is the ratio of the push and the weight.
        (0.35, 0.3, ("slides under push shove (needs friction of 0.35, the floor has 0.3)",)),
        (0.25, 0.3, ()),
        (1.5, 2.0, ("falls under push shove",)),
        (1.5, 0.3, ("falls under push shove",)),
    ],
)
def test_a_pushed_bench_slides_or_tips(tmp_path, share: float, friction: float, words: tuple[str, ...]) -> None:
    still = bench(tmp_path, 0.0, friction)
    weight = 10.0 * (20.0 + float(still.geometry().mass.sum()))
    # It tips where the push at 0.51 m is more than the weight at 0.509 m from its feet's edge; else it slides.
    found = bench(tmp_path, share * weight, friction).test()
    assert tuple(one for one in found.words if "under" in one and "weak" not in one) == words


@pytest.mark.parametrize(
    ("incline", "words"),
    [(0.4, "slides under its weights (needs friction of 0.423, the floor has 0.2)"), (1.2, "falls under its weights")],
)
def test_a_block_on_an_incline(incline: float, words: str) -> None:
    # It tips where the incline is more than its base over its height, 0.5; it slides where tan(0.4) = 0.4228 is more
    # than the friction.
    assert Furniture(block(0.1, 0.2, 0.2, incline)).test().words == (words,)


def test_what_slides_says_how_much_mass_holds_it(tmp_path) -> None:
    slippery = bench(tmp_path, 100.0, 0.1).piece
    mass = 20.0 + float(Furniture(slippery).geometry().mass.sum())
    # With g of 10 m/s2 and friction of 0.1 a push of 100 N is held by 100 kg.
    assert enough_mass(slippery) == pytest.approx(100.0 - mass, rel=1e-9)
    why = Design(slippery, Guidance()).suggestion_list.why
    needed = 100.0 / (10.0 * mass)
    assert f"friction of {rounded_up(needed)} would hold it ([floor] friction is 0.1)" in why
    assert f"or {rounded_up(100.0 - mass)} kg more on it" in why and "effects.guidance.freedoms" not in why


def test_a_piece_that_turns_as_it_slides_needs_more_than_the_ratio_of_forces(tmp_path) -> None:
    # Pushed along y at one end, the bench turns about the foot at its other end.
    text = BENCH + PUSH.replace("[FORCE, 0, 0]", "[0, 60, 0]\nat = [0.5, 0, 0]") + "\n[floor]\nfriction = 0.1\n"
    piece = Furniture(piece_of(load_scene(write_bench(tmp_path, text)))).moved()
    (finding,) = (one for one in Furniture(piece).test().findings if one.kind == FALLS)
    ratio = 60.0 / (10.0 * (20.0 + float(Furniture(piece).geometry().mass.sum())))
    assert finding.value > 1.2 * ratio
    assert falling_cases(on_floor(piece, finding.value)) == set()
    assert falling_cases(on_floor(piece, finding.value * (1.0 - 2.0 * CLOSE))) == {1}


@pytest.mark.parametrize("turned", [False, True])
def test_a_weight_without_a_place_lies_on_top(tmp_path, turned: bool) -> None:
    ends = "from = [-0.6, 0, 0.51]\nto = [0.6, 0, 0.51]"
    other = "from = [0.6, 0, 0.51]\nto = [-0.6, 0, 0.51]"
    piece = piece_of(load_scene(write_bench(tmp_path, BENCH.replace(ends, other if turned else ends))))
    (load,) = piece.weights
    plank = piece.planks[load.plank]
    assert (plank.centre + plank.axes @ (np.array(load.place) * plank.size))[2] == pytest.approx(0.52)


def test_the_top_of_an_upright_plank_is_its_end() -> None:
    post = Plank.between("post", (0, 0, 0), (0, 0, 1), (0, 0.1, 0), 0.02)
    assert top_of(post) == (0.5, 0.0, 0.0)
    edge = Plank.between("edge", (0, 0, 0), (1, 0, 0), (0, 0, -0.1), 0.02)
    assert top_of(edge) == (0.0, -0.5, 0.0)
