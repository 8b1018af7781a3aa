"""Supports that go far at once: the cloth comes along, and does not pass through itself on the way."""

import re

import numpy as np
import pytest
from restshape_studies.stability.case import Trial
from restshape_verification.couture.hard_scenes import pinned, played, square

from restshape.physics.cloth.relaxation import keep_apart

NEAR = '[supports.near]\non = "c"\nfix = { x = -0.12, y = 0, z = 0 }\n'
UPRIGHT = '[start]\nturn = ["90 deg", 0, 0]\n'


@pytest.mark.slow
@pytest.mark.parametrize("turned", ["", UPRIGHT])
def test_cloth_starts_drawn_along_by_a_support_that_lies_inside_it(tmp_path, turned):
    """A pin 120 mm inside the flat cloth would be across triangles of 30 mm."""
    made, (row,) = played(Trial(tmp_path), square(0.03, pinned("d"), NEAR, turned))
    assert row["converged"] and row["tangent_positive_definite"] == 1
    assert row["crossings"] == 0 and "across" not in row["note"] and not row["untrusted"]
    corner = np.abs(made.analysis.problem.mesh.X - (0.3, 0.3)).sum(axis=1).argmin()
    assert made.analysis.problem.corners(made.analysis.x)[corner, 0] == pytest.approx(0.18)


@pytest.mark.slow
def test_cloth_that_hangs_is_lifted_by_a_pin_in_one_frame(tmp_path):
    """From one pin to two: a pin that took its triangles with it alone would be across others."""
    lift = {"do": "set", "key": "supports", "value": {}}
    lift["value"] = {
        "d": {"on": "d", "fix": ["x", "y", "z"]},
        "near": {"on": "c", "fix": {"x": -0.12, "y": 0, "z": 0}},
    }
    _, rows = played(Trial(tmp_path), square(0.03, pinned("a", "d"), UPRIGHT), [lift])
    assert all(row["converged"] and row["crossings"] == 0 and not row["untrusted"] for row in rows)
    assert not any(row["untrusted"] for row in rows)


@pytest.mark.slow
def test_cloth_that_is_dropped_again_is_not_to_be_trusted(tmp_path, monkeypatch):
    """A pin that an edit takes through the cloth, in fewer parts than lead around it."""
    monkeypatch.setattr(keep_apart, "PARTS", 1)
    lift = {"do": "set", "key": "supports", "value": {}}
    lift["value"] = {
        "d": {"on": "d", "fix": ["x", "y", "z"]},
        "far": {"on": "b", "fix": {"x": -0.3, "y": 0, "z": 0.3}},
    }
    _, rows = played(Trial(tmp_path), square(0.03, pinned("a", "d"), UPRIGHT), [lift])
    assert "dropped again" in rows[-1]["untrusted"]
    # It says how far the cloth has jumped, and how its energy differs from that of the last rest: nothing worked on it.
    jumped = re.search(
        r"cloth jumped \d+ mm where the hand went \d+ mm; energy (fell|rose) by (\S+) mJ", rows[-1]["note"]
    )
    fell = rows[-2]["q_potential"] - rows[-1]["q_potential"]
    assert float(jumped[2]) * (1.0 if jumped[1] == "fell" else -1.0) == pytest.approx(1e3 * fell, rel=0.01)
