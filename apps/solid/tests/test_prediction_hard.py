"""Design derivatives with an old factor; the hard cases are in `test_hard_cases`."""

import numpy as np
import pytest
from restshape_verification.solid.stability_static import unrefreshed
from small_scenes import PULLED, across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.sensitivity.steady_derivative import design_derivative

LARGE = "[effects.large_deformation]\n"
FOLLOWING = PULLED.replace('traction = ["100 MPa", 0]', 'pressure = "-100 MPa"')


@pytest.mark.parametrize("text", [plate(), plate() + LARGE, plate().replace(PULLED, FOLLOWING) + LARGE])
def test_with_an_old_factor_after_a_long_drag(tmp_path, text):
    # CG or GMRES on a preconditioner that is never rebuilt, against a factor of the very matrix. Where a factor costs
    # that much, multigrid takes its place in large deformation; with following loads, whose matrix is not symmetric,
    # the factors by which every tenth frame shows that it is stable are kept.
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.62, 0.5), 39))[:2])
    found = []
    for name, calibration in (("auto", unrefreshed()), ("refactor", None)):
        scene = write_scene(tmp_path, text)
        tight = ["solve.tolerance=1e-10", "mesh.min_quality=0.01"]
        made = make_replay(scene, script, name, tight, calibration=calibration)
        rows = rows_of(made)
        assert all(row["level"] < 2 for row in rows[1:])
        found.append((rows, design_derivative(made.analysis, made.moving.field_motion, 1e-10)))
    (rows, stale), (_, fresh) = found
    refreshed = [row["index"] for row in rows if row["pc_rebuilt"]]
    expected = (40, 1) if LARGE not in text else (9, 4) if FOLLOWING in text else (38, 2)
    assert (rows[-1]["pc_age"], len(refreshed)) == expected
    np.testing.assert_allclose(stale, fresh, atol=1e-6 * np.abs(fresh).max())
