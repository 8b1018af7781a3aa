"""Cloth in equilibrium: against closed forms, against other strategies for the same equilibrium, and what is kept
between frames."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cloths import BALL, CONTACT, PIN, cloth, write_cloth
from petsc4py import PETSc

from restshape.algebra.nonlinear.kinetic_damping import KineticDamping, Steps
from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Context
from restshape.analysis.frame import Frame
from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.relaxation import binding
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.relaxation_equations import ClothEquations
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene, revise
from restshape.scene.plan import plan

ROOT = Path(__file__).parents[2]
INCLINE = Path(__file__).parents[1] / "scenes" / "incline.toml"
NONE = np.empty(0, dtype=np.int32)
CLAMP = '[supports.clamp]\non = "left"\nfix = ["x", "y", "z", "slope"]\n'
WEAK = "[effects.gravity]\ng = [0, 0, -1e-7]\n"


def analysis_of(scene, name="auto"):
    context = Context(PETSc.COMM_SELF, policy(name), Calibration.load(), Stages())
    return RelaxationAnalysis(scene, plan(scene, application("cloth")), context)


def replay_of(scene, script=None):
    made = script or Script.empty(scene)
    return Replay(Request(scene, made, application("cloth"), policy("auto"), Calibration.load()), PETSc.COMM_SELF)


def solved(scene, name="auto", mesh=None):
    """The analysis after the first frame, on a mesh or on that of a replay."""
    if mesh is None:
        replay = replay_of(scene)
        next(replay.frames())
        return replay.analysis
    found = analysis_of(scene, name)
    found.solve(Frame(mesh, NONE, None, scene, (None, (0.0, 0.0))))
    return found


def independent_residual(found):
    """The residual at equilibrium from differences of the energy, over the weight."""
    rng, x, h = np.random.default_rng(3), found.x, 1e-8
    out = np.zeros_like(x)
    found.problem.residual(x, out)
    for _ in range(3):
        v = rng.uniform(-1, 1, x.shape) * found.problem.boundary.free
        slope = (found.problem.energy(x + h * v) - found.problem.energy(x - h * v)) / (2 * h)
        assert slope == pytest.approx((out * v).sum(), abs=1e-7)
    return np.linalg.norm(out) / found.problem.lumped.load


def test_a_weak_plate_deflects_as_a_cantilever(tmp_path):
    """D w'''' = q: tip q L^4 / (8 D) where nu = 0."""
    text = write_cloth(tmp_path, CLAMP).read_text().replace("nu = 0.25", "nu = 0").replace("[effects.gravity]\n", WEAK)
    path = tmp_path / "weak.toml"
    path.write_text(text)
    scene = load_scene(path, ["mesh.size=0.125", "effects.drape.tolerance=1e-3"])
    found = solved(scene)
    D, q = 2e6 * 0.5e-3**3 / 12, 0.2 * 1e-7
    tip = found.problem.corners(found.x)[found.space.X[:, 0] > 1 - 1e-9, 2].mean()
    assert tip == pytest.approx(-q / (8 * D), rel=0.02)
    assert found.state.report.converged and found.state.report.stable


@pytest.mark.parametrize("bending", ["morley", "hinge", "nonlinear", "none"])
def test_pinned_cloth_comes_to_rest(tmp_path, bending):
    pins = PIN + '[supports.other]\non = "d"\nfix = ["x", "y", "z"]\n'
    scene = cloth(tmp_path, pins, overrides=(f"effects.cloth.bending={bending}", "mesh.size=0.15"))
    found = solved(scene)
    assert found.state.report.converged
    assert independent_residual(found) <= 1e-4
    weight = found.problem.lumped.density.mean() * 9.81
    out = np.zeros_like(found.x)
    found.problem.unconstrained_residual(found.x, out)
    constrained = found.problem.boundary.mask.any(axis=1)
    assert out[constrained, 2].sum() == pytest.approx(weight, rel=1e-3)


def test_cloth_lies_on_the_ball_and_not_in_it(tmp_path):
    scene = cloth(tmp_path, BALL, CONTACT, overrides=("mesh.size=0.12", "effects.cloth.bending=hinge"))
    found = solved(scene)
    assert found.state.report.converged and found.state.report.stable
    assert independent_residual(found) <= 1e-4
    distance = np.linalg.norm(found.problem.corners(found.x) - (0.5, 0.5, -0.3), axis=1) - 0.25
    # A penalty lets cloth in by a part of its thickness, 2 mm.
    assert distance.min() > -1e-3
    assert (distance < 2e-3).sum() > 3


def test_two_ways_find_the_one_rest(tmp_path):
    """A cantilever hangs in one way only: kinetic damping and descent agree, and so does a start from elsewhere."""
    shape = cloth(
        tmp_path, CLAMP, overrides=("mesh.size=0.2", "effects.drape.tolerance=1e-7", "effects.cloth.bending=hinge")
    )
    usual = solved(shape)
    moved = solved(revise(shape, "effects.drape.strategy", "kinetic"), mesh=usual.space)
    assert usual.state.report.converged and moved.state.report.converged
    np.testing.assert_allclose(moved.x, usual.x, atol=1e-5)
    lifted = solved(revise(shape, "start", {"move": [0.0, 0.0, 0.0], "scatter": 0.02}), mesh=usual.space)
    np.testing.assert_allclose(lifted.x, usual.x, atol=1e-5)


def test_the_same_bytes_twice(tmp_path):
    scene = cloth(tmp_path, BALL, CONTACT, overrides=("mesh.size=0.15",))
    first, second = solved(scene), solved(scene)
    assert first.x.tobytes() == second.x.tobytes()


@pytest.mark.slow
def test_nested_meshes_lead_to_rest(tmp_path):
    scene = cloth(tmp_path, BALL, CONTACT, overrides=("mesh.size=0.1", "mesh.levels=3"))
    found = solved(scene)
    assert found.space.hierarchy is not None and found.state.report.converged
    assert independent_residual(found) <= 1e-4


def test_what_is_not_converged_says_so(tmp_path):
    scene = cloth(tmp_path, PIN, overrides=("effects.drape.steps=3", "mesh.size=0.2"))
    found = solved(scene)
    reported = found.row()
    assert not reported["converged"] and reported["tangent_positive_definite"] == -1
    assert (
        reported["note"].startswith("not converged: residual ")
        and f"{found.state.report.residual:.2e}" in reported["note"]
    )
    assert found.residual_norm() == pytest.approx(found.state.report.residual, rel=1e-6)


@pytest.mark.slow
def test_anchors_go_with_their_body(tmp_path):
    """Cloth that sticks to a ball goes along with it, wherever it goes."""
    scene = cloth(tmp_path, BALL, CONTACT, overrides=("mesh.size=0.2", "effects.cloth.bending=hinge"))
    rough = revise(scene, "bodies.ball.friction", 5.0)
    found = solved(rough)
    # Points of triangles bear the load beside corners.
    contact, mesh = found.problem.contact, found.space
    before = contact.place(found.problem.corners(found.x)).copy()
    touching = contact.history.limits[0] > 0.0
    assert touching.any()
    aside = revise(rough, "bodies.ball.sphere.center", [0.52, 0.5, -0.3])
    found.solve(Frame(mesh, NONE, None, aside, (None, (0.0, 0.0))))
    assert found.state.report.converged
    way = contact.place(found.problem.corners(found.x)) - before
    np.testing.assert_allclose(way[touching].mean(axis=0), [0.02, 0.0, 0.0], atol=1e-3)


@pytest.mark.parametrize("radius", [0.24, 0.26])
def test_cloth_stays_on_a_ball_that_shrinks_or_grows(tmp_path, monkeypatch, radius):
    """Without a derivative the guess takes nodes along with the surface: friction remembers."""
    monkeypatch.setattr(binding, "drag_frame", lambda state, _: (state, False))
    scene = cloth(tmp_path, BALL, CONTACT, overrides=("mesh.size=0.08", "effects.cloth.bending=hinge"))
    found = solved(scene)
    contact, before = found.problem.contact, found.problem.corners(found.x).copy()
    limits = contact.history.limits[0, : len(before)].copy()
    found.solve(Frame(found.space, NONE, None, revise(scene, "bodies.ball.sphere.radius", radius), (None, (0.0, 0.0))))
    guess = found.problem.corners(found.bound.x)
    touching = limits > 0.0
    assert touching.any()
    distance = [np.linalg.norm(x[touching] - [0.5, 0.5, -0.3], axis=1) for x in (before, guess)]
    np.testing.assert_allclose(distance[1] / distance[0], radius / 0.25, rtol=1e-12)
    assert (contact.bodies[0].distance(guess)[0][touching] < contact.thickness * radius / 0.25).all()
    assert found.state.report.converged


@pytest.mark.parametrize("bending", ["morley", "hinge"])
def test_what_sticks_does_so_whatever_its_mesh(tmp_path, bending):
    """A patch below the angle of friction stays while its nodes move, edges flip, and the mesh is another."""
    scene = load_scene(INCLINE, ['parameters.slope="15 deg"', f"effects.cloth.bending={bending}"])
    script = tmp_path / "edits.jsonl"
    script.write_text(
        '{"format": "restshape-edits", "version": 1, "scene": "incline.toml", "units": "m"}\n'
        '{"t": 0, "do": "press", "on": "c"}\n{"t": 1, "do": "drag", "to": [0.2, 0.16], "frames": 10}\n'
        '{"t": 2, "do": "release"}\n{"t": 3, "do": "set", "key": "mesh.size", "value": "8 mm"}\n'
        '{"t": 4, "do": "set", "key": "effects.cloth.bending", "value": "nonlinear"}\n{"t": 5, "do": "undo"}\n'
    )
    replay, places, levels = replay_of(scene, load_script(script, scene)), [], set()
    for row in replay.frames():
        found = replay.analysis
        assert found.state.report.converged
        levels.add(row["level"])
        corner = found.space.vertex_node[list(scene.shape.vertices).index("a")]
        places.append(found.problem.corners(found.x)[corner])
    assert levels == {0, 1, 2, 3}
    # Friction that had forgotten would let it slip by a tenth of a millimetre each time.
    assert np.ptp(places, axis=0).max() < 1e-6


def test_frames_after_an_error_go_on_from_the_last_rest(tmp_path):
    scene = cloth(tmp_path, BALL, CONTACT, overrides=("mesh.size=0.2", "effects.contact.stiffness=5e4"))
    script = tmp_path / "edits.jsonl"
    script.write_text(
        '{"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"}\n'
        '{"t": 0, "do": "set", "key": "bodies.ball.sphere.radius", "value": 0.26}\n'
        '{"t": 1, "do": "set", "key": "material.cotton.rho", "value": 0}\n'
        '{"t": 2, "do": "set", "key": "bodies.ball.sphere.radius", "value": 0.27}\n'
    )
    replay = replay_of(scene, load_script(script, scene))
    rows = list(replay.frames())
    assert "density" in rows[2]["refused"]
    assert [row["converged"] for row in rows] == [1, 1, -1, 1]


@pytest.mark.parametrize("bending", ["morley", "hinge", "none"])
def test_moved_material_takes_its_place_on_the_cloth(tmp_path, bending):
    """Flat cloth keeps its place while its nodes move in it; nothing has to be found again."""
    scene = cloth(
        tmp_path,
        '[supports.flat]\non = "all"\nfix = ["z"]\n[supports.a]\non = "a"\nfix = ["x", "y"]\n'
        '[supports.b]\non = "b"\nfix = ["y"]\n',
        overrides=(f"effects.cloth.bending={bending}",),
    )
    found = solved(scene)
    inner = np.flatnonzero(found.space.node_edge < 0)[:5]
    found.space.X[inner] += 0.01
    found.problem.update()
    morley = found.problem.morley
    x = found.state.advected.unknowns_at(found.problem.place, morley.side_number if morley else None)
    np.testing.assert_allclose(found.problem.corners(x)[:, :2], found.space.X, atol=1e-9)
    assert found.problem.bending_energy(x) < 1e-20


def test_a_saddle_is_left(tmp_path):
    """A sheet that stands upright on its clamp stays so while q L^3 / D < 7.84, and finds another rest beyond."""
    text = write_cloth(tmp_path, CLAMP).read_text()
    path = tmp_path / "upright.toml"
    path.write_text(text.replace("[effects.gravity]\n", "[effects.gravity]\ng = [-1.0, 0, 0]\n"))
    light = load_scene(path, ["mesh.size=0.2", "effects.cloth.bending=hinge", "material.cotton.bending=0.1"])
    found = solved(light)
    assert found.state.report.converged and found.state.report.stable
    upright = found.x.copy()
    assert np.abs(found.problem.corners(upright)[:, 2]).max() < 1e-6
    heavy = revise(light, "effects.gravity.g", [-9.81, 0, 0])
    found.solve(Frame(found.space, NONE, None, heavy, (None, (0.0, 0.0))))
    assert found.state.report.converged and found.state.report.stable
    assert found.problem.energy(found.x) < found.problem.energy(upright) - 0.1


def test_what_nothing_holds_is_not_stable(tmp_path):
    """Flat cloth without weight and bending resists no displacement across it: its tangent is singular."""
    path = write_cloth(tmp_path, PIN, '[supports.other]\non = "d"\nfix = ["x", "y", "z"]\n')
    path.write_text(path.read_text().replace("[effects.gravity]\n", ""))
    found = solved(load_scene(path, ["mesh.size=0.25", "effects.cloth.bending=none"]))
    assert found.state.report.converged and found.state.report.stable is False
    assert "unstable" in found.row()["note"]


def test_empty_scripts_show_one_frame(tmp_path):
    scene = cloth(tmp_path, PIN, overrides=("mesh.size=0.25",))
    replay = replay_of(scene)
    (row,) = replay.frames()
    assert row["converged"] == 1 and row["residual"] <= 1e-4 and 0.0 < row["estimate"] < 2.0


BAR = """
[bodies.bar]
capsule = { start = [0.45, 0.55, -0.3], end = [0.45, 0.55, 0.3], radius = 0.03 }
"""


def test_a_body_that_comes_through_is_reported(tmp_path):
    """A bar stands between the nodes of a triangle of 0.2 m: all nodes rest, and the bar is in the cloth."""
    pins = "".join(f'[supports.{c}]\non = "{c}"\nfix = ["x", "y", "z"]\n' for c in "abcd")
    tunnelled = solved(cloth(tmp_path, pins, BAR, CONTACT, overrides=("mesh.size=0.3", "effects.cloth.bending=hinge")))
    assert "bodies.bar comes through the cloth" in tunnelled.row()["untrusted"]
    ball = solved(cloth(tmp_path, BALL, CONTACT, overrides=("mesh.size=0.12", "effects.cloth.bending=hinge")))
    assert ball.row()["note"] == ""


@pytest.mark.slow
@pytest.mark.parametrize("bending", ["hinge", "morley"])
def test_steps_know_of_new_supports_bending_and_nodes(tmp_path, bending):
    """Their matrix in blocks, kept over all changes, is that of new equations in rows."""
    scene = cloth(tmp_path, PIN, CONTACT, BALL, overrides=(f'effects.cloth.bending="{bending}"',))
    sheet = solved(scene).problem
    kept = ClothEquations(sheet, PETSc.COMM_SELF, Stages())
    assert kept.steps.operator.backend == "bcsr"
    rng, inertia = np.random.default_rng(5), 300.0
    x = sheet.flat(np.column_stack([sheet.mesh.X, np.zeros(len(sheet.mesh.X))]))
    x = x + 0.02 * rng.uniform(-1, 1, x.shape) * sheet.boundary.free

    def matrices():
        new = ClothEquations(sheet, PETSc.COMM_SELF, Stages(), "csr")
        forces, expected = np.empty_like(x), np.empty_like(x)
        blocks, rows = kept.step_matrix(x, inertia, True, forces), new.step_matrix(x, inertia, False)
        # In the same pass, and without what inertia and stabilisation add to the matrix.
        new.residual(x, expected)
        off = np.abs(forces - expected)[sheet.boundary.mask == 0]
        assert off.max() < 1e-12 * np.abs(expected).max()
        assert blocks.getType() == "seqbaij" and rows.getType() == "seqaij"
        return blocks.convert("dense", PETSc.Mat()).getDenseArray().copy(), rows[:, :]

    found = []
    for change in (
        lambda: None,
        lambda: sheet.boundary.mask.__setitem__(slice(20, 30), 1),
        lambda: setattr(sheet, "fabric", replace(sheet.fabric, bending=3.0 * sheet.fabric.bending)),
        lambda: sheet.mesh.X.__imul__(1.1),
    ):
        change()
        if found:
            mask = sheet.boundary.mask.copy()
            sheet.update()
            sheet.boundary.mask[:] = mask
        blocks, rows = matrices()
        assert blocks == pytest.approx(rows, abs=1e-14 * np.abs(rows).max())
        assert all(np.abs(blocks - before).max() > 1e-6 * np.abs(rows).max() for before in found)
        found.append(blocks)


@pytest.mark.parametrize(("kind", "blocks"), [("sor", True), ("gamg", False), ("eisenstat", False), ("icc", False)])
def test_motion_takes_the_preconditioner_of_the_petsc_options(tmp_path, kind, blocks):
    found = solved(cloth(tmp_path, PIN, overrides=('effects.cloth.bending="hinge"',)))
    sheet, options = found.problem, PETSc.Options()
    equations = ClothEquations(sheet, PETSc.COMM_SELF, Stages())
    options.setValue("reported_step_pc_type", kind)
    steps = Steps(1 / 60, longest=1 / 60, most=5)
    shape, rows = found.x.shape, equations.rows
    moving = KineticDamping(PETSc.COMM_SELF, "reported_", equations, equations.mass, shape, rows, steps)
    options.delValue("reported_step_pc_type")
    x = sheet.flat(np.column_stack([sheet.mesh.X, np.zeros(len(sheet.mesh.X))]))
    moving.run(x, 0.0)
    assert moving.linear.blocks is blocks and equations.steps.patterned is blocks
    assert moving.iterations > 0 and sheet.corners(x)[:, 2].min() < -1e-4
    moving.free()


TABLE = """
[bodies.table]
box = { center = [0.5, 0.5, CENTRE], half = [0.3, 0.3, 0.04] }
friction = 0.3
"""


@pytest.mark.slow
@pytest.mark.parametrize(("centre", "begins"), [(-0.05, ""), (-0.03, "10"), (0.0, "40")])
def test_cloth_that_begins_inside_a_body_is_reported(tmp_path, centre, begins):
    scene = cloth(
        tmp_path, CONTACT, TABLE.replace("CENTRE", str(centre)), overrides=("mesh.size=0.12", "effects.drape.steps=12")
    )
    row = solved(scene).row()
    assert ("begins" in row["note"]) == bool(begins)
    if begins:
        assert f"cloth begins {begins} mm inside bodies.table" in row["note"]


@pytest.mark.parametrize(("stiffness", "reported"), [(2e3, True), (5e7, False)])
def test_the_largest_penetration_of_a_triangle_is_reported(tmp_path, stiffness, reported):
    """By the distance from a ball in closed form; soft contact gives by more than half its thickness."""
    found = solved(cloth(tmp_path, CONTACT, BALL, overrides=(f"effects.contact.stiffness={stiffness}",)))
    corners = found.problem.corners(found.x)
    i, j = (part.ravel() for part in np.mgrid[:31, :31])
    inside = np.column_stack([i, j, 30 - i - j])[i + j <= 30] / 30
    places = np.einsum("pk,eka->epa", inside, corners[found.space.cells])
    # The ball's centre goes by a parameter of 0.5.
    depth = 0.25 - np.linalg.norm(places - [0.5, 0.5, -0.3], axis=2).min()
    row = found.row()
    assert row["max_penetration"] == pytest.approx(max(depth, 0.0), abs=1e-4)
    depth = row["max_penetration"]
    assert bool(depth > 0.5 * found.problem.contact.thickness) is reported
    assert (f"cloth lies {1e3 * depth:.3g} mm inside bodies.ball" in row["untrusted"]) is reported
