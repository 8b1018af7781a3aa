"""Bodies that move through cloth, at any speed: it is pushed, and none passes."""

import numpy as np
import pytest
from restshape_studies.stability.case import Trial
from restshape_verification.couture.drapes import box
from restshape_verification.couture.hard_scenes import BALL, CONTACT, pinned, played, square


@pytest.mark.slow
@pytest.mark.parametrize("frames", [1, 3])
def test_a_ball_pushes_a_curtain_at_every_size_of_step(tmp_path, frames):
    """Across a curtain that hangs in its way: the curtain is on the side that the ball came to, and back it hangs."""
    text = square(0.03, BALL.format(x=-0.2, y=0.1, z=-0.12, radius=0.05, friction=0.3), CONTACT, pinned("left"))
    path = [(-0.2 + 0.25 * (k + 1) / frames, 0.1) for k in range(frames)]
    events = [{"do": "press", "on": "ball", "at": [-0.2, 0.1]}]
    events += [{"do": "drag", "to": list(to), "frames": 1} for to in path]
    made, rows = played(Trial(tmp_path), text, [*events, {"do": "release"}])
    x, contact = made.analysis.problem.corners(made.analysis.x), made.analysis.problem.contact
    near = np.abs(x[:, 1] - 0.1) < 0.03
    ahead = x[near & (np.abs(x[:, 2] + 0.12) < 0.03), 0]
    assert len(ahead) and ahead.min() > 0.05, "what hangs at the ball's height is before it"
    assert contact.bodies[0].lowest(x, contact.cells, 1e-5)[0] > -1e-3
    assert all(row["converged"] for row in rows) and any("parts" in row["note"] for row in rows)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "angle"), [("hinge", 60), ("morley", 60), ("hinge", 150)])
def test_cloth_turns_with_the_box_that_it_lies_on(tmp_path, kind, angle):
    """About its vertical axis, in one frame: an equilibrium stays one, and nothing is left to do."""
    text = square(0.05, box("table", (0.15, 0.15, -0.052), (0.1, 0.08, 0.05)), CONTACT, kind=kind)
    turn = {"do": "set", "key": "bodies.table.box.rotate.2", "value": f"{angle} deg", "frames": 1}
    _, (before,) = first, _ = played(Trial(tmp_path), text)
    made, rows = played(Trial(tmp_path), text, [turn])
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    middle = np.array([0.15, 0.15, 0.0])
    x = [one.analysis.problem.corners(one.analysis.x) - middle for one in (first, made)]
    np.testing.assert_allclose(x[1], x[0] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]), atol=1e-3)
    assert before["converged"] and rows[1]["converged"] and rows[1]["relaxation_steps"] < 30
    assert rows[1]["q_potential"] == pytest.approx(before["q_potential"], rel=1e-4)
