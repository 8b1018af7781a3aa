"""Energy and forces of a sheet in one pass: those of its elements."""

import numpy as np
import pytest

from restshape import _kernels as k


def strip(count: int):
    """A strip of so many triangles, places in space of its corners and sides, and cells of what bends by element."""
    rng, n = np.random.default_rng(count), count + 2
    corners = np.array([(i, i + 1, i + 2) if i % 2 else (i, i + 2, i + 1) for i in range(count)], dtype=np.int32)
    X = np.column_stack([0.5 * np.arange(n), -(np.arange(n) % 2)]) + rng.uniform(-0.1, 0.1, (n, 2))
    X[:, 1] *= np.sign(np.linalg.det(X[corners[0, 1:]] - X[corners[0, 0]]))
    sides = n + 3 * np.arange(count)[:, None] + np.arange(3)
    hinges = [(i + 1, i + 2, i, i + 3) if i % 2 else (i + 2, i + 1, i, i + 3) for i in range(count - 1)]
    bent = {
        "morley_tri6": np.hstack([corners, sides]).astype(np.int32),
        "hinge_flap4": np.array(hinges, np.int32).reshape(-1, 4),
    }
    X = np.vstack([X, np.zeros((3 * count, 2))])
    return X, rng.normal(size=(len(X), 3)) + 100.0, corners, bent


def own_and_known(count: int, bends: str, each: bool):
    """Energy and forces in one pass, and those of the elements one by one."""
    X, x, corners, bent = strip(count)
    rng = np.random.default_rng(1)
    parts = [("membrane_tri3", corners), *([(bends, bent[bends])] if bends else [])]
    given = [(k.Element(name), cells, len(k.Element(name).parameters)) for name, cells in parts]
    rows = [rng.uniform(0.5, 2.0, (len(cells), wide) if each else wide) for _, cells, wide in given]
    energy, forces, found = 0.0, np.zeros_like(x), np.full_like(x, np.nan)
    for (element, cells, _), row in zip(given, rows):
        energy += element.energy(X, x, cells, row).sum()
        element.residual(X, x, cells, row, forces)
    cells, stiffness = (given[1][1], rows[1]) if bends else (np.empty((0, 0), np.int32), np.empty(0))
    own = k.Sheet(X, corners, rows[0], bends, cells, stiffness).evaluate(x, found)
    return own, found, energy, forces


@pytest.mark.parametrize("bends", ["", "hinge_flap4", "morley_tri6"])
@pytest.mark.parametrize("each", [True, False])
@pytest.mark.parametrize("count", [2, 8, 9, 23])
def test_a_sheet_has_energy_and_forces_of_its_elements(bends, each, count):
    own, found, energy, forces = own_and_known(count, bends, each)
    assert own == pytest.approx(energy, rel=1e-13)
    np.testing.assert_allclose(found, forces, rtol=0, atol=1e-13 * np.abs(forces).max())


def test_a_sheet_counts_what_it_evaluates():
    k.reset_calls()
    X, x, corners, bent = strip(5)
    sheet = k.Sheet(X, corners, np.ones(9), "hinge_flap4", bent["hinge_flap4"], np.ones(1))
    sheet.evaluate(x, np.empty_like(x))
    calls = k.calls()
    assert calls["membrane_tri3"] == {"residual": (1, 5), "energy": (1, 5)}
    assert calls["hinge_flap4"] == {"residual": (1, 4), "energy": (1, 4)}


def test_a_sheet_refuses_what_does_not_fit():
    X, x, corners, bent = strip(5)
    plates = bent["morley_tri6"]
    with pytest.raises(ValueError, match="as many nodes as their elements"):
        k.Sheet(X, plates, np.ones(9), "", plates, np.empty(0))
    with pytest.raises(ValueError, match="a node that does not exist"):
        k.Sheet(X[:6], corners, np.ones(9), "", plates, np.empty(0))
    with pytest.raises(ValueError, match="a row of parameters"):
        k.Sheet(X, corners, np.ones(9), "morley_tri6", plates, np.ones(8))
    with pytest.raises(ValueError, match="hinge_flap4, of morley_tri6 or empty"):
        k.Sheet(X, corners, np.ones(9), "membrane_tri3", corners, np.ones(9))
    with pytest.raises(ValueError, match="x must have the shape"):
        k.Sheet(X, corners, np.ones(9), "", plates, np.empty(0)).evaluate(x[1:], x)
