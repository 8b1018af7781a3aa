"""What slides is distinguished from what falls, by hand; weights without a place lie on top."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Furniture
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
        (0.35, 0.3, ("slides under push shove",)),
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


@pytest.mark.parametrize(("incline", "words"), [(0.4, "slides under its weights"), (1.2, "falls under its weights")])
def test_a_block_on_an_incline(incline: float, words: str) -> None:
    # It tips where the incline is more than its base over its height, 0.5.
    assert Furniture(block(0.1, 0.2, 0.2, incline)).test().words == (words,)


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
