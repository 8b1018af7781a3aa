"""Columns that buckle: what is shown has a tangent without negative eigenvalues, by LAPACK."""

import numpy as np
import pytest
from restshape_verification.solid.stability_columns import DEPTH, EULER, THICKNESS, column
from small_scenes import across, drag, make_replay, rows_of, write_scene, write_script

from restshape.algebra.factors.gathering import gather_matrix


def negative(analysis):
    """Eigenvalues of the tangent stiffness with a negative real part."""
    return int(np.sum(np.linalg.eigvals(gather_matrix(analysis.tangent(), analysis.context.comm).toarray()).real < 0))


@pytest.mark.parametrize("share", [0.97, 3.0])
def test_a_load_put_on_at_once(tmp_path, share):
    start = ["loads.weight.force=[0, -1]"]
    script = write_script(tmp_path, [{"do": "set", "key": "loads.weight.force", "value": [0, -share * EULER]}])
    made = make_replay(write_scene(tmp_path, column(1.0)), script, overrides=start)
    _, row = rows_of(made)
    assert bool(row["refused"]) == (share > 1)
    assert negative(made.analysis) == 0


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.95, 1.05])
def test_a_load_that_follows_in_part(tmp_path, share, following=1 / 3):
    # A share f < 1/2 of the force N turns with the top: at the limit cos(k L) = f / (f - 1), k^2 = N / (E I).
    limit = EULER * (np.arccos(following / (following - 1)) / (np.pi / 2)) ** 2
    assert limit == pytest.approx(EULER * (16 / 9 if following else 1))
    begin = column((1 - following) * 0.3 * limit, following * 0.3 * limit)
    value = {"do": "set", "key": "loads.weight.force", "value": [0, -(1 - following) * share * limit]}
    events = [value]
    if following:
        pressure = following * share * limit / (DEPTH * THICKNESS)
        events = [{"do": "set", "key": "loads.jet.pressure", "value": pressure}, value]
    made = make_replay(write_scene(tmp_path, begin), write_script(tmp_path, events))
    rows = rows_of(made)
    assert made.analysis.solver.kind == ("lu" if following else "cholesky")
    assert not any(row["refused"] for row in rows[:-1])
    assert bool(rows[-1]["refused"]) == (share > 1)
    assert negative(made.analysis) == 0
    if share < 1 and following:
        K = gather_matrix(made.analysis.tangent(), made.analysis.context.comm)
        assert abs(K - K.T).max() > 1e-4 * abs(K).max()


@pytest.mark.slow
def test_what_is_shown_after_a_drag_beyond_the_limit_stands(tmp_path):
    # At 0.8 times Euler's load a column stands up to the length 1 / sqrt(0.8) = 1.118.
    script = write_script(tmp_path, drag("top", (DEPTH / 2, 1.0), across((DEPTH / 2, 1.0), (DEPTH / 2, 1.4), 5)))
    made = make_replay(write_scene(tmp_path, column(0.8 * EULER)), script, predict="linear")
    rows = rows_of(made)
    # Either the release is refused too, or what is shown since is the last column that stands.
    assert rows[-1]["event"] == "release" and bool(rows[-1]["refused"]) == (negative(made.analysis) > 0)


@pytest.mark.slow
@pytest.mark.parametrize("predict", ["none", "linear"])
def test_a_column_dragged_up_to_its_limit_is_shown(tmp_path, predict):
    script = write_script(tmp_path, drag("top", (DEPTH / 2, 1.0), across((DEPTH / 2, 1.0), (DEPTH / 2, 1.1), 30)))
    made = make_replay(write_scene(tmp_path, column(0.8 * EULER)), script, predict=predict)
    unstable = []
    rows = rows_of(made, lambda row: row["index"] % 8 or unstable.append(negative(made.analysis)))
    assert not any(row["refused"] for row in rows) and len(unstable) == 5 and not any(unstable)
    # The factors that show it are counted: one in ten frames, and one at the end.
    assert sum(row["pc_rebuilt"] for row in rows) >= (4 if predict == "none" else 2)


def test_a_column_beyond_its_limit_is_reported_where_its_state_was_given(tmp_path):
    # As between predicted frames: what was accepted, and not solved for, lets nobody believe in the next equilibrium.
    path = across((DEPTH / 2, 1.0), (DEPTH / 2, 1.4), 5)
    script = write_script(tmp_path, drag("top", (DEPTH / 2, 1.0), path))
    made = make_replay(write_scene(tmp_path, column(0.8 * EULER)), script)
    for row in made.frames():
        if row["index"] < 2:
            continue
        length = path[row["index"] - 2][1]
        assert bool(row["refused"]) == (length > np.sqrt(1 / 0.8))
        if row["refused"]:
            break
        made.analysis.predictor.set_values(made.analysis.x)
