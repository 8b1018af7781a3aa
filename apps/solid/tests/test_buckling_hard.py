"""Load factors that are lost, and compared with LAPACK; the hard cases are in `test_hard_cases`."""

import numpy as np
import pytest
from columns import FOOT, Column, column
from petsc4py import PETSc
from restshape_verification.solid.stability_buckling import PULL, masts
from scipy.linalg import eigh
from small_scenes import across, drag, make_replay, write_scene, write_script

from restshape.algebra.eigenproblems.eigen import COUNT_EVERY
from restshape.algebra.factors.gathering import gather_matrix
from restshape.analysis.buckling.buckling_matrices import products
from restshape.cli.main import main


def test_a_lost_mode_is_found_by_the_next_count(tmp_path):
    """The lowest mode is taken from all that a frame begins with: the count misses it, and it is found."""
    design = Column(tmp_path, column(modes=2))
    solver, state = design.analysis.solver, design.analysis.state
    lost = state.modes.vectors[0]
    stiff = products(state.prebuckling.problem, lost[None], state.prebuckling.x, state.sign)[0]
    solver.history = [block[1:] - (block[1:] @ stiff.T) * lost for block in solver.history]
    solver.unchecked, solver.known = COUNT_EVERY, 2
    found = design.move(1e-6 * np.sin(design.X))
    assert design.analysis.state.report.missed_modes >= 1
    np.testing.assert_allclose(found, design.load_factors, rtol=1e-3)


@pytest.mark.slow
def test_a_picture_of_the_modes(tmp_path, capsys):
    path = write_scene(tmp_path, column())
    assert (
        main(["buckling", str(path), "--out", str(tmp_path / "a.png")]) == 0
        and (tmp_path / "a.png").stat().st_size > 1e4
    )
    pulled = write_scene(tmp_path, column(FOOT, PULL.format(1e3)), "pulled.toml")
    assert main(["buckling", str(pulled), "--out", str(tmp_path / "b.png")]) == 2 and not (tmp_path / "b.png").exists()
    assert "nothing buckles" in capsys.readouterr().err


def dense(analysis) -> float:
    """The lowest positive load factor by LAPACK, which cannot miss it."""
    pencil = analysis.solver.pencil
    G, K = (gather_matrix(m, PETSc.COMM_SELF).toarray() for m in (pencil.stiffness, pencil.mass))
    free = analysis.state.prebuckling.problem.boundary.mask.ravel() == 0
    return (
        1.0
        / eigh(
            -G[np.ix_(free, free)], K[np.ix_(free, free)], eigvals_only=True, subset_by_index=2 * [int(free.sum()) - 1]
        )[0]
    )


@pytest.mark.slow
def test_a_mast_that_becomes_the_weakest_is_seen_when_the_hand_rests(tmp_path, frames=4):
    """The last of five, the thickest, is dragged thinner than the others, of which it knows nothing."""
    text, side = masts([0.05, 0.052, 0.054, 0.056, 0.11])
    way = across((side, 0.5), (side - 0.06875, 0.5), frames)
    script = write_script(tmp_path, [*drag("e1", (side, 0.5), way), {"do": "idle", "frames": 2}])
    made = make_replay(write_scene(tmp_path, text), script)
    rows, known = [], -1
    for row in made.frames():
        rows.append(row)
        assert not row["refused"], row["refused"]
        if row["inertia_checked"] and made.analysis.state.prebuckling.geometry != known:
            right, known = dense(made.analysis), made.analysis.state.prebuckling.geometry
        if row["inertia_checked"]:
            assert row["mu_1"] == pytest.approx(right, rel=1e-5), row["index"]
    assert rows[-1]["mu_1"] < 0.7 * rows[0]["mu_1"]
    resting = [row for row in rows if row["event"] in ("release", "idle")]
    assert all(row["inertia_checked"] for row in resting) and not any(row["missed_modes"] for row in resting[1:])
    assert resting[0]["q_first"] == resting[0]["mu_1"]
