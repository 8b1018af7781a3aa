"""The estimate of cloth beside the distance from a far finer solution of the same folds, and what it knows exactly."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cloths import PIN, cloth
from petsc4py import PETSc

from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Context
from restshape.analysis.frame import Frame
from restshape.application import application
from restshape.calibration import Calibration
from restshape.mesh.generate import generate
from restshape.mesh.nested import NestedMesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.binding import bind
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.sheet.cloth_boundary import ClothSupports
from restshape.physics.cloth.sheet.cloth_error_estimate import ClothEstimate
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.patch_curvature import PatchCurvature
from restshape.policy import policy
from restshape.scene.load import load_scene
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.scene.plan import plan
from restshape.shape.build import outline_from_spec

SCENES = Path(__file__).parents[1] / "scenes"
C = 300.0 * np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
D = 1e-5 * np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
FREE = np.array([0.0, 0.0, 0.0])


def square(size=0.13):
    """A mesh of the unit square."""
    corners = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}
    names = list(corners)
    edges = {f"{a}{b}": {"line": [a, b]} for a, b in zip(names, [*names[1:], names[0]])}
    spec = ShapeSpec.model_validate({"outline": list(edges), "vertices": corners, "edges": edges})
    return generate(outline_from_spec(spec, Path()), MeshSpec(size=size))


def context():
    """What a replay shares, on one rank."""
    return Context(PETSc.COMM_SELF, policy("auto"), Calibration.load(), Stages())


def loose(mesh, kind):
    """Cloth that nothing holds."""
    none = np.zeros((len(mesh.X), 3))
    return ClothProblem(mesh, Fabric(C, D, 0.2, kind), ClothSupports(none.astype(bool), none), FREE)


def settled(name, mesh, overrides):
    """The analysis of a scene's first frame, on a mesh of the scene where none is given."""
    scene = load_scene(SCENES / f"{name}.toml", overrides)
    mesh = mesh or generate(outline_from_spec(scene.shape, scene.folder), scene.mesh)
    planned, none = plan(scene, application("cloth")), np.empty(0, dtype=np.int32)
    found = RelaxationAnalysis(scene, planned, context())
    found.solve(Frame(mesh, none, None, scene, (None, (0.0, 0.0)), edit_ended=True))
    assert found.state.report.converged
    return found


def finer(coarse, levels, name, overrides):
    """Sheet and positions of the same folds on a mesh with 4^levels times as many triangles, which is the reference."""
    nest, x = NestedMesh(coarse.space, levels + 1), coarse.problem.corners(coarse.x)
    for level in range(levels):
        x = nest.prolong(level, x)
    fine = settled_from(name, nest.finest, overrides, x)
    return fine.problem, fine.x


def settled_from(name, mesh, overrides, corners):
    """The analysis of a scene on a mesh, from positions (corners, 3) near rest."""
    scene = load_scene(SCENES / f"{name}.toml", overrides)
    found = RelaxationAnalysis(scene, plan(scene, application("cloth")), context())
    none = np.empty(0, dtype=np.int32)
    frame = Frame(mesh, none, None, scene, (None, (0.0, 0.0)), edit_ended=True)
    bound, _ = bind(found.state, frame, True, found._options(scene, True), None)
    x = bound.problem.flat(corners)
    assert bound.solver.converge(x, 3000, ConvergenceReport()).converged
    found.state = replace(bound, x=x, scene=scene)
    return found


def distance(coarse, sheet, x, levels):
    """How far the strains of a coarse analysis are from those of fine cloth, over these, in the energy norm."""
    fine, parent = ClothEstimate(sheet), np.arange(len(sheet.mesh.cells)) // 4**levels
    tension = sheet.tensions(x) - coarse.problem.tensions(coarse.x)[parent]
    curved = fine.curvatures(x) - coarse.error_estimate.curvatures(coarse.x)[parent]
    fabric = sheet.fabric
    twice = np.einsum("e,ei,ij,ej->", fine.area, tension, np.linalg.inv(fabric.membrane), tension)
    twice += np.einsum("e,eai,ij,eaj->", fine.area, curved, fabric.bending, curved)
    return np.sqrt(twice / (2.0 * (sheet.membrane_energy(x) + sheet.bending_energy(x))))


def test_patches_have_the_curvatures_of_quadratic_surfaces():
    mesh = square()
    x, y = mesh.X.T
    found = PatchCurvature(mesh.X, mesh.cells)(np.column_stack([x, x * x - 0.5 * x * y, 3.0 * y * y + x]))
    np.testing.assert_allclose(found, np.tile([[0, 0, 0], [2, 0, -1], [0, 6, 0]], (len(mesh.cells), 1, 1)), atol=1e-6)


def test_patches_of_a_mesh_too_small_for_a_quadratic_surface_are_not_curved():
    X = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    flat = PatchCurvature(X, np.array([[0, 1, 2]], dtype=np.int32))(X @ [[1.0], [2.0]])
    np.testing.assert_allclose(flat, 0.0, atol=1e-4)


@pytest.mark.parametrize("kind", ["morley", "hinge", "nonlinear", "none"])
def test_uniform_strain_has_no_error(kind):
    sheet = loose(square(), kind)
    flat = np.column_stack([1.1 * sheet.mesh.X[:, 0], 0.9 * sheet.mesh.X[:, 1], 0.2 * sheet.mesh.X[:, 0]])
    assert ClothEstimate(sheet).relative(sheet.flat(flat)) < 1e-6


def test_materials_that_meet_have_no_error_of_their_own(tmp_path):
    scene = cloth(tmp_path, PIN)
    mesh = generate(outline_from_spec(scene.shape, scene.folder), scene.mesh)
    assert len(np.unique(mesh.cell_region)) == 2
    inside = (mesh.cell_region > 0)[:, None, None]
    none = np.zeros((len(mesh.X), 3))
    fabric = Fabric(np.where(inside, 100.0 * C, C), np.where(inside, 100.0 * D, D), 0.2, "morley")
    sheet = ClothProblem(mesh, fabric, ClothSupports(none.astype(bool), none), FREE)
    stretched = sheet.flat(np.column_stack([1.1 * mesh.X[:, 0], mesh.X[:, 1], none[:, 0]]))
    assert ClothEstimate(sheet).relative(stretched) < 1e-6


def test_what_is_not_strained_has_no_estimate():
    sheet = loose(square(), "morley")
    flat = sheet.flat(np.column_stack([sheet.mesh.X, np.zeros(len(sheet.mesh.X))]))
    assert np.isnan(ClothEstimate(sheet).relative(flat))


def test_moments_of_a_uniform_curvature_have_no_error():
    sheet = loose(square(), "morley")
    # A shallow bowl, of which only the bending is looked at: the membrane is the same with none of it.
    bowl = sheet.morley.placed(
        lambda X: np.column_stack([X, (X**2).sum(axis=1)]),
        lambda X: np.stack([np.tile([1.0, 0.0], (len(X), 1)), np.tile([0.0, 1.0], (len(X), 1)), 2.0 * X], axis=1),
    )
    estimate = ClothEstimate(sheet)
    moments = estimate.curvatures(bowl)[:, 2] @ D
    assert estimate._distance(moments, D) < 1e-20 * D[0, 0] + 1e-12 * sheet.bending_energy(bowl)


def test_nodes_that_move_are_followed():
    mesh = square()
    sheet = loose(mesh, "hinge")
    estimate = ClothEstimate(sheet)
    mesh.X *= 2.0
    mesh.geometry += 1
    sheet.update()
    estimate.update()
    x, y = mesh.X.T
    found = estimate.curvatures(np.column_stack([x, y, x * x]))
    np.testing.assert_allclose(found[:, 2], np.tile([2.0, 0.0, 0.0], (len(found), 1)), atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size", "levels", "more", "bounds"),
    [
        ("cloth_strip", 3.125e-3, 2, (), {"morley": (0.9, 1.1), "hinge": (0.6, 1.2)}),
        # Tensions at pins are singular, and cells as wide as folds show less than their error.
        ("pins", 0.07, 1, ("supports.right.fix.x=-0.1",), {"morley": (0.5, 1.2), "hinge": (0.4, 1.2)}),
    ],
)
def test_effectivity(name, size, levels, more, bounds):
    overrides = (f"mesh.size={size}", "solve.tolerance=1e-5", *more)
    coarse, reference = None, None
    for kind, (least, most) in bounds.items():
        own = (*overrides, f"effects.cloth.bending={kind}")
        found = (
            settled(name, coarse and coarse.space, own)
            if coarse is None
            else settled_from(name, coarse.space, own, coarse.problem.corners(coarse.x))
        )
        if coarse is None:
            coarse, reference = found, finer(found, levels, name, overrides)
        effectivity = found.errors()["estimate"] / distance(found, *reference, levels)
        print(name, kind, effectivity)
        assert least < effectivity < most
