"""Seams whose sides would begin nearer to each other if their edges came in another order."""

import numpy as np
import pytest
from small_scenes import write_scene
from test_pattern_panels import garment

from restshape.application import application
from restshape.physics.cloth.relaxation.start_check import check_start
from restshape.physics.cloth.seams.seam_order import FEW, Order
from restshape.scene.load import load_scene
from restshape.scene.plan import plan
from restshape.shape.build import outline_from_spec

RING = """
[panels.{name}]
outline = ["front", "back"]
vertices = {{ west = [-0.2, 0], east = [0.2, 0] }}
edges = {{ front = {{ arc = ["west", "east"], bulge = 1 }}, back = {{ arc = ["east", "west"], bulge = 1 }} }}
holes = {{ neck = {{ circle = {{ center = [0, 0], radius = 0.06 }} }} }}
move = [0, 0, {height}]
"""
HELD = '[supports.held]\non = "low.front"\nfix = ["x", "y", "z"]\n'
PANELS = RING.format(name="low", height=0) + RING.format(name="high", height=0.01) + HELD
ROUND = [1, 2, 3, 4]


def noted(folder, first: list[int], second: list[int], keys: str = "") -> list[str]:
    """What is noted of two rings that begin 10 mm above each other, sewn at their holes in these orders of edges."""
    edges = {"from": [f"low.neck.{k}" for k in first], "to": [f"high.neck.{k}" for k in second]}
    seam = "[seams.neck]\n" + "".join(f"{key} = {names}\n" for key, names in edges.items()) + keys
    scene = load_scene(write_scene(folder, garment(PANELS, seam)))
    return check_start(scene, plan(scene, application("cloth")), outline_from_spec(scene.shape))


@pytest.mark.parametrize("turned", [1, 2, 3])
def test_a_seam_that_is_turned_is_noted_with_the_order_that_is_not(tmp_path, turned):
    [note] = noted(tmp_path, ROUND, ROUND[turned:] + ROUND[:turned])
    # Holes are octagons on the mesh. Places a quarter of a turn apart, or mirror images, which half a turn comes to,
    # have twice the mean square of their distance from the middle; the rings lie 10 mm above each other.
    square = 0.06**2 * (1.0 - 2.0 / 3.0 * np.sin(np.pi / 8.0) ** 2)
    far = 1e3 * np.sqrt(2.0 * square + 0.01**2)
    assert note.startswith(f"seams.neck.to: both sides begin {far:.3g} mm apart, and 10 mm in the order high.neck.1, ")
    assert note.endswith("high.neck.3, high.neck.4: is its order the right one?")


def test_the_right_order_has_no_note(tmp_path):
    assert not noted(tmp_path, ROUND, ROUND)
    assert not noted(tmp_path, ROUND, ROUND, "reverse = true\n")


def test_a_long_order_is_named_by_its_first_edge():
    text = str(Order("seams.waist.from", tuple(f"e{k}" for k in range(FEW + 1)), 0.01, 0.2))
    assert text.startswith(
        "seams.waist.from: both sides begin 200 mm apart, and 10 mm in the order that begins with e0:"
    )
