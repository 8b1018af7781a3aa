"""Constrained unknowns are no modes of their own, however coarse the mesh and however many modes are wanted."""

import numpy as np
import pytest
from modal import SCENES
from scipy.linalg import eigh

from restshape.errors import UserError
from restshape.interface.first_frame import first_frame


def exact(analysis) -> np.ndarray:
    """All frequencies [Hz] of the free unknowns by LAPACK, ascending, rigid ones left out."""
    K, M = (m.toarray() for m in analysis.state.matrices.gather())
    free = analysis.state.body.boundary.mask.ravel() == 0
    values = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(values[len(analysis.state.body.free_rigid_motions()) :]) / (2 * np.pi)


@pytest.mark.parametrize("name", ["auto", "refactor", "thesis"])
def test_a_coarse_plate_with_many_modes(name):
    """Its 35 free unknowns have 35 modes; those of the constrained ones, which K and M have rows of, lie among them."""
    over = ["mesh.size=3", "effects.modal.modes=20", f"solve.policy={name}"]
    analysis = first_frame(SCENES / "supported.toml", over).analysis
    constrained = analysis.state.body.boundary.mask.ravel() == 1
    assert constrained.any() and not analysis.state.modes.vectors[:, constrained].any()
    assert analysis.frequencies == pytest.approx(exact(analysis)[:20], rel=1e-6)


def test_more_modes_than_the_mesh_has():
    with pytest.raises(UserError, match="40 modes are asked for, and the mesh has 35 only"):
        first_frame(SCENES / "supported.toml", ["mesh.size=3", "effects.modal.modes=40"])


def test_a_bar_held_in_a_rubber_grommet(tmp_path):
    """Soft constrained cells have low K_hh / M_hh: their rows would be counted below the modes that are wanted."""
    text = (SCENES / "bar_200.toml").read_text()
    ring = """[shape.regions.pad]
circle = { center = ["40 mm", "15 mm"], radius = "9 mm" }
[shape.holes.pin]
circle = { center = ["40 mm", "15 mm"], radius = "3 mm" }
[material.rubber]
region = ["pad"]
E = "0.3 MPa"
nu = 0.45
rho = "1100 kg/m^3"
thickness = "4 mm"
[supports.pin]
on = "pin"
fix = ["z", "rx", "ry"]
"""
    scene = tmp_path / "grommet.toml"
    scene.write_text(text.replace("[material.aluminium]", ring + "[material.aluminium]"))
    over = ["effects.modal.model=plate", 'mesh.size="8 mm"', "effects.modal.modes=15", "solve.tolerance=1e-6"]
    analysis = first_frame(scene, over).analysis
    assert analysis.state.report.inertia_checked
    assert analysis.frequencies == pytest.approx(exact(analysis)[:15], rel=1e-5)
