"""Reactions of cloth: forces of supports alone, also where the cloth is not at rest."""

import pytest
from drape_designs import COTTON
from small_scenes import block, head, meshed, write_scene

from restshape.interface.first_frame import first_frame

SCENE = (
    head("cloth")
    + block(0.2, 0.1)
    + COTTON.format(kind="morley", bending=5e-6)
    + '[quantities]\nup = { reaction = "z", at = "all" }\nbeside = { reaction = "z", at = "right" }\n'
    + meshed(0.05)
)
WEIGHT = 500 * 0.3e-3 * 9.81 * 0.02


def test_cloth_that_nothing_holds_has_no_reaction(tmp_path):
    """It falls past a ball: what it weighs is no force of a support."""
    ball = "[bodies.ball]\nsphere = { center = [5, 0, -0.2], radius = 0.1 }\n[effects.contact]\n"
    row = first_frame(write_scene(tmp_path, SCENE + ball)).row
    assert row["converged"] == 0 and row["residual"] > 0.5
    assert row["q_up"] == row["q_beside"] == 0.0


def test_pins_bear_the_weight_and_free_nodes_nothing(tmp_path):
    pin = '[supports.pin]\non = "left"\nfix = ["x", "y", "z"]\n'
    row = first_frame(write_scene(tmp_path, SCENE + pin)).row
    assert row["q_up"] == pytest.approx(WEIGHT, rel=1e-3) and row["q_beside"] == 0.0
