"""Validation cases where the answer is known beyond what meshes give: discrete forms, rates, norms, remainders."""

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, ROUNDING, Check
from restshape_studies.validation.shear_waves import mindlin
from restshape_verification.metallophone.reference import EDITS, SCENES, solved

from restshape.algebra.eigenproblems.eigen import EigenSolver
from restshape.algebra.stages import Stages
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.modal.modal_matrices import products
from restshape.calibration import Calibration
from restshape.interface.replays import replay_files

CELLS = 60
"""Of the one-dimensional bar whose discrete eigenvalues are known."""


def discrete(_comm: PETSc.Comm) -> list[Check]:
    """A free bar of linear elements, of consistent and of lumped mass: the solver against discrete closed forms."""
    checks = []
    waves = np.arange(1, 5) * np.pi / CELLS
    exact = {
        "consistent": 6 * (1 - np.cos(waves)) / (2 + np.cos(waves)),
        "lumped": 2 * (1 - np.cos(waves)),
    }
    for mass, values in exact.items():
        for method in ("auto", "direct"):
            K, M = bar(mass == "consistent")
            solver = EigenSolver(method, 1e-10, Calibration.load(), Stages())
            found, _ = solver.solve(K, M, np.ones((1, CELLS + 1)), 4, True)
            source = "linear elements, closed form of the discrete problem"
            checks += [
                Check(
                    f"bar, {mass} mass, {method}, eigenvalue {k + 1}",
                    float(value),
                    float(ref),
                    ROUNDING,
                    source,
                    CLOSED_FORM,
                )
                for k, (value, ref) in enumerate(zip(found.values, values))
            ]
    return checks


def bar(consistent: bool) -> tuple[PETSc.Mat, PETSc.Mat]:
    """K and M of a free bar of unit elements with E = rho = 1."""
    n = CELLS + 1
    K = np.diag(np.r_[1.0, np.full(n - 2, 2.0), 1.0]) - np.eye(n, k=1) - np.eye(n, k=-1)
    M = np.diag(np.r_[0.5, np.ones(n - 2), 0.5])
    if consistent:
        M = (np.diag(np.r_[2.0, np.full(n - 2, 4.0), 2.0]) + np.eye(n, k=1) + np.eye(n, k=-1)) / 6
    rows = np.arange(0, n * n + 1, n, dtype=np.int32), np.tile(np.arange(n, dtype=np.int32), n)
    # One full pattern, so that both have the same.
    K, M = (PETSc.Mat().createAIJ((n, n), csr=(*rows, part.ravel()), comm=PETSc.COMM_SELF) for part in (K, M))
    return K, M


def rates(comm: PETSc.Comm) -> list[Check]:
    """Errors of frequencies over the size of the elements: order 2 p for solids, 2 for the plate."""
    pushed = [
        'supports.wall.on="bottom"',
        'supports.wall.fix=["y"]',
        "material.steel.nu=0",
        "effects.modal.modes=1",
        "solve.tolerance=1e-8",
        "shape.vertices.c=[1, 0.2]",
        "shape.vertices.d=[0, 0.2]",
    ]
    # Without lateral contraction u = cos(pi x / L) is a mode.
    exact = 0.5 * np.sqrt(210e9 / 7850.0)
    checks = []
    for order, sizes in ((1, (0.05, 0.0125)), (2, (0.1, 0.025))):
        found = [solved("slender.toml", comm, [*pushed, f"mesh.order={order}", f"mesh.size={s}"]) for s in sizes]
        words = f"free strip along itself, elements of order {order}: order of convergence"
        checks.append(Check(words, slope(found, exact), 2.0 * order, 0.1, "f = sqrt(E / rho) / 2 L", CLOSED_FORM))
    thick, sizes = ["material.steel.thickness=1", "effects.modal.modes=1", "solve.tolerance=1e-8"], (0.8, 0.2)
    found = [solved("supported.toml", comm, [*thick, f"mesh.size={s}"]) for s in sizes]
    words = "supported plate, thickness 1/10: order of convergence"
    return [*checks, Check(words, slope(found, mindlin(found[0], 10.0, 1, 1)), 2.0, 0.1, "Mindlin", CLOSED_FORM)]


def slope(found: Sequence[ModalAnalysis], exact: float) -> float:
    """The power of the elements' size, as their number reports it, that the error of the first frequency follows."""
    coarse, fine = (abs(float(analysis.frequencies[0]) - exact) for analysis in found)
    cells = [len(analysis.space.cells) for analysis in found]
    return float(np.log(coarse / fine) / (0.5 * np.log(cells[1] / cells[0])))


def norms(comm: PETSc.Comm) -> list[Check]:
    """Modes of unit mass, orthogonal to each other and to rigid motions, in each model."""
    checks = []
    for what, scene, overrides in (
        ("tetrahedra", "bar_100.toml", ["effects.modal.modes=5"]),
        ("second-order tetrahedra", "bar_100.toml", ["effects.modal.modes=5", "mesh.order=2", "mesh.layers=1"]),
        ("plate", "square.toml", []),
        ("plane stress", "slender.toml", []),
    ):
        analysis = solved(scene, comm, overrides)
        modes = analysis.state.modes.vectors
        mass_products = products(analysis.state.body, modes)[1]
        gram = float(np.abs(modes @ mass_products.T - np.eye(len(modes))).max())
        checks.append(Check(f"{what}: largest entry of phi M phi - 1", gram, 0.0, ROUNDING, "definition", IDENTITY))
        rigid = analysis.state.body.free_rigid_motions()
        if len(rigid):
            mixed = np.abs(mass_products @ rigid.T) / np.linalg.norm(rigid, axis=1)
            share = float((mixed / np.linalg.norm(mass_products, axis=1)[:, None]).max())
            checks.append(Check(f"{what}: largest rigid share of a mode", share, 0.0, ROUNDING, "definition", IDENTITY))
    return checks


def remainders(_comm: PETSc.Comm) -> list[Check]:
    """What prediction by the derivative leaves along a drag shrinks with the square of the way."""
    checks = []
    for what, overrides in (
        ("tetrahedra", []),
        ("second-order tetrahedra", ["mesh.order=2", "mesh.layers=1", 'mesh.size="15 mm"']),
        ("plate", ["effects.modal.model=plate"]),
    ):
        words = (SCENES / "bar_100.toml", EDITS / "remainder.jsonl", "auto", [*overrides, "solve.tolerance=1e-9"])
        solved_rows, ahead = (
            [row for row in replay_files(*words, predict=kind)["rows"] if row["event"] == "drag"]
            for kind in ("none", "linear")
        )
        left = [abs(a["f_1"] - b["f_1"]) for a, b in zip(solved_rows, ahead)]
        order = float(np.log2(left[1] / left[0]))
        checks.append(
            Check(f"{what}: order of the remainder of f_1", order, 2.0, 0.03, "Taylor, full solves", IDENTITY)
        )
    return checks
