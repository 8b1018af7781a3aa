"""Reuse verification of cloth: a restart from perturbed positions comes back, and what it must notice."""

from dataclasses import replace

import numpy as np
import pytest
from cloths import BALL, CONTACT, PIN, cloth
from petsc4py import PETSc

from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.parity import ENTRIES, Parity
from restshape.replay.request import Request
from restshape.scene.edit_script import Script
from restshape.scene.load import revise

HUNG = (PIN, PIN.replace("pin", "other").replace('"a"', '"d"'))


def relaxed(folder, *parts):
    """A replay of a cloth of which the first frame is relaxed."""
    scene = cloth(folder, *parts)
    request = Request(scene, Script.empty(scene), application("cloth"), policy("auto"), Calibration.load())
    made = Replay(request, PETSc.COMM_SELF)
    next(made.frames())
    return made


@pytest.fixture(scope="module")
def hung(tmp_path_factory):
    """The analysis of a cloth that hangs from two corners."""
    return relaxed(tmp_path_factory.mktemp("hung"), *HUNG).analysis


@pytest.mark.parametrize("parts", [HUNG, (BALL, CONTACT)], ids=["hung", "ball"])
def test_a_perturbed_restart_comes_back(tmp_path, parts):
    made = relaxed(tmp_path, *parts)
    check = Parity(made)
    found = check()
    assert made.analysis.state.report.converged
    assert found["parity_entries"] <= ENTRIES and 0 < found["parity_solution"] <= made.analysis.tolerance
    assert check.summary()["holds"]


def changed(analysis, **state):
    """The difference from a cold solve of a state that is another."""
    kept = analysis.state
    analysis.state = replace(kept, **state)
    try:
        return analysis.compare_cold()
    finally:
        analysis.state = kept


def test_places_that_are_off_are_noticed(hung):
    swung, X = hung.x.copy(), hung.state.mesh.X
    swung[: len(X), 1] += 2e-3 * np.sin(0.5 * np.pi * X[:, 0])
    assert changed(hung, x=swung).solution > hung.tolerance


def test_a_cloth_whose_weight_stays_behind_is_noticed(hung):
    heavier = revise(hung.state.scene, "material.cotton.rho", "404 kg/m^3")
    assert changed(hung, scene=heavier).solution > hung.tolerance


def test_a_stiffness_that_stays_behind_is_noticed(hung):
    stiffer = revise(hung.state.scene, "material.cotton.E", "2.02 MPa")
    found = changed(hung, scene=stiffer)
    assert found.entries > 1e-3 and found.solution > hung.tolerance


@pytest.mark.parametrize("name", ["energy", "membrane_energy", "bending_energy"])
def test_an_energy_that_is_off_is_noticed(hung, monkeypatch, name):
    own, value = hung.problem, getattr(ClothProblem, name)
    size = sum(abs(getattr(own, each)(hung.x)) for each in ("energy", "membrane_energy", "bending_energy"))

    def off(self, x):
        return value(self, x) + (2e-4 * size if self is own else 0.0)

    monkeypatch.setattr(ClothProblem, name, off)
    assert changed(hung).solution > hung.tolerance
