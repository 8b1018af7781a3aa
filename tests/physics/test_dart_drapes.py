"""Drapes of cloth with darts: their derivative by a dart's width, and frames that go on from the last mesh."""

import json

import numpy as np
import pytest
from drape_designs import HELD, DrapeDesign, sheet
from small_scenes import make_replay, rows_of, write_scene, write_script

from restshape.errors import UserError
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.physics.cloth.sensitivity.scene_numbers import ChangingNumber
from restshape.replay.parity import Parity
from restshape.scene.model import Scene
from restshape.shape.build import unchecked_outline

DART = '[darts.dart]\nedge = "right"\nlength = 0.08\nwidth = 0.03\n'
QUANTITIES = '[quantities]\nlowest = { position = "z", reduce = "min" }\npotential = { energy = "potential" }\n'
WIDER = [{"t": 0, "do": "set", "key": "darts.dart.width", "value": 0.04, "frames": 2}]


TWO = """
[parameters]
k = 0.03
[darts.dart]
edge = "right"
at = 0.45
length = 0.08
width = "k"
[darts.inner]
line = [[0.05, 0.05], [0.05, 0.15]]
width = 0.02
"""


@pytest.mark.parametrize(
    ("tables", "keys"),
    [
        (TWO, ("parameters.k", "darts.dart.at", "darts.inner.line.0.1")),
        (DART + "folded = true\n", ("darts.dart.width",)),
        ("", ("shape.vertices.b.0",)),
    ],
    ids=["cut", "folded", "corner"],
)
def test_remainders_of_derivatives_by_numbers_of_the_pattern_are_of_second_order(tmp_path, tables, keys):
    """The drape of the pattern that the scene has a step on, which the derivative knows nothing of."""
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, tables, size=0.1))
    for key in keys:
        number = ChangingNumber(design.scene, design.analysis.state.plan, key)
        s, found = design.analysis.number_derivatives([key], 1e-10).s[0], []
        for h in (1e-3, 5e-4):
            there = number.scene_with(number.value + h)
            found.append(float(np.linalg.norm(design.move(motion_to(design, there), there) - design.x - h * s)))
        assert 1e-10 < found[0] < 0.05 * 1e-3 * np.linalg.norm(s), f"{key}: {found}"
        assert 1.8 < np.log2(found[0] / found[1]) < 2.2, f"{key}: {found}"


def motion_to(design: DrapeDesign, scene: Scene) -> np.ndarray:
    """How (n, 2) [m] the mesh's nodes move as the outline becomes that of another scene, harmonically inside."""
    mesh = design.analysis.space
    step = unchecked_outline(scene.shape).points - mesh.outline.points
    basis = np.stack([step, np.zeros_like(step)])
    return motion(mesh, BoundaryNodes(mesh).basis(mesh.outline, basis), "harmonic")[0]


@pytest.mark.parametrize(
    ("at", "key"),
    [("1", "darts.dart.at"), ('"min(k, 1)"', "parameters.k")],
)
def test_a_dart_that_comes_to_a_corner_has_no_derivative_there(tmp_path, at, key):
    dart = f'[parameters]\nk = 1\n{DART}at = {at}\nangle = "45 deg"\n'
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, dart, size=0.1))
    with pytest.raises(UserError, match="at an end of what it may be"):
        design.analysis.number_derivatives([key], 1e-8)


def test_a_wider_dart_keeps_the_mesh_and_rests_as_when_solved_again(tmp_path):
    scene, script = (
        write_scene(tmp_path, sheet("hinge", HELD, DART, QUANTITIES, size=0.05)),
        write_script(tmp_path, WIDER),
    )
    reused, rebuilt = (make_replay(scene, script, name=name) for name in ("auto", "rebuild"))
    check = Parity(reused)
    rows = rows_of(reused, lambda row: row.update(check()))
    assert [row["level"] for row in rows[1:]] == [1, 1] and all(row["converged"] for row in rows)
    # One mesh, one rest: forces, positions and energies of a cold solve.
    found = check.summary()
    assert found["holds"] and found["entries"] < 1e-12 and found["solution"] < 1e-8, found
    # Another mesh, with its own nodes inside: the energy is that of the same cloth.
    again = rows_of(rebuilt)
    assert rows[-1]["q_potential"] == pytest.approx(again[-1]["q_potential"], rel=2e-3)
    areas = [replay.analysis.problem.lumped.area.sum() for replay in (reused, rebuilt)]
    assert areas == pytest.approx([0.2**2 - 0.5 * 0.04 * 0.08] * 2, rel=1e-12)


@pytest.mark.mpi
@pytest.mark.parametrize("folded", ["", pytest.param("folded = true\n", marks=pytest.mark.weekly)])
def test_two_ranks_rest_as_one(tmp_path, on_ranks, folded):
    # Without friction and layers, so that there is one rest.
    text = sheet("hinge", HELD, DART + folded, QUANTITIES, size=0.1) + "\n[effects.contact]\nself = false\n"
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, WIDER)
    found = []
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", scene, "--edits", script, "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    assert (one["ranks"], two["ranks"], two["refused"]) == (1, 2, 0) and one["levels"] == two["levels"]
    for name, values in one["quantities"].items():
        np.testing.assert_allclose(two["quantities"][name], values, rtol=1e-6, err_msg=name)
