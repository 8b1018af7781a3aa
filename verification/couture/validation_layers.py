"""Validation cases of cloth on cloth: a strip folded over itself, and a sheet that slips on another one."""

# More than 15 modules: cloth of two sheets is made here, with all that it is solved by.

from dataclasses import replace

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import CLOSED_FORM, Check
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from restshape.algebra.linear import LinearSolver
from restshape.algebra.stages import Stages
from restshape.application import application
from restshape.calibration import Calibration
from restshape.interface.first_frame import first_frame
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.self_contact.self_contact import SelfContact, SelfContactValues
from restshape.physics.cloth.sheet.cloth_boundary import ClothSupports

SCENES = application("couture").folder / "scenes"
FOLDED = [
    *(f"shape.vertices.{name}={place}" for name, place in (("b", [0.3, 0]), ("c", [0.3, 0.02]), ("d", [0, 0.02]))),
    *(f"material.cotton.{key}={value}" for key, value in (("E", 40e6), ("nu", 0), ("rho", 600), ("thickness", 5e-4))),
    "material.cotton.bending=23.544e-6",
    "parameters.slope=0",
    "bodies.ground.plane.point=[0,0,-0.0001]",
    "bodies.ground.friction=0",
    "effects.contact.thickness=1e-4",
    "effects.contact.self_thickness=2.5e-4",
    "mesh.size=2.5e-3",
]
"""A strip of 15 lengths of the fold, (D/w)^(1/3) = 20 mm, on a floor."""
START = 1e-2
"""Length of the series with which the shooting begins, over the length of the fold."""
GUESS = 0.45
"""Radius of the loop that the strip is laid in at first, over the length of the fold."""
MOST = 3_000
SHEET_SIZE = 0.01
"""Mesh size [m] of the sheets that slip."""
SLIPS = ((0.3, 20, 1.01), (2.0, 20, 1.01), (0.3, 10, 1.03), (0.3, 5, 1.05))
"""Coefficients of friction, mesh size over the distance where contact begins, and part of the angle that slips."""


def loop_height(gap: float) -> float:
    """Height of the fold of a heavy strip on a plane, its layers a gap apart, both over (D/w)^(1/3).

    D theta'' = n_x sin(theta) - n_z cos(theta), n_z' = w; theta and its rate are 0 where the strip leaves the plane,
    and pi and 0 where it comes to lie on itself. With D theta'^2/2 + n_x cos(theta) + n_z sin(theta) - w z, which is
    constant, n_x = -w gap/2. The force where the strip leaves the plane is found by shooting.
    """

    def shot(force: float) -> tuple[float, float]:
        def rates(s: float, y: np.ndarray) -> list[float]:
            angle, bent = y[:2]
            turned = -0.5 * gap * np.sin(angle) + (force - s) * np.cos(angle)
            return [bent, turned, np.cos(angle), np.sin(angle)]

        def landed(s: float, y: np.ndarray) -> float:
            return y[1]

        landed.terminal, landed.direction = True, 1
        begin = [force * START**2 / 2, force * START, START, force * START**3 / 6]
        found = solve_ivp(rates, (START, 12.0), begin, events=landed, rtol=1e-11, atol=1e-13, max_step=0.02)
        return float(found.y[0, -1]), float(found.y[3].max())

    return shot(brentq(lambda force: shot(force)[0] - np.pi, 3.6, 3.9))[1]


def folded_strip(comm: PETSc.Comm) -> list[Check]:
    """The height of a fold whose upper layer lies on the lower one."""
    analysis = first_frame(SCENES / "incline.toml", FOLDED, comm).analysis
    sheet = analysis.problem
    along, x = sheet.mesh.X[:, 0], sheet.corners(analysis.x).copy()
    weight = float(np.max(sheet.fabric.density)) * float(np.linalg.norm(sheet.g))
    length = float(np.max(sheet.fabric.bending) / weight) ** (1.0 / 3.0)
    bottom, radius, begin, end = x[:, 2].mean(), GUESS * length, 0.5 * along.max(), 0.5 * along.max()
    end += np.pi * radius
    turn, above = np.clip((along - begin) / radius, 0.0, np.pi), np.maximum(along - end, 0.0)
    x[:, 0] = np.minimum(along, begin) + radius * np.sin(turn) - above
    x[:, 2] = bottom + radius * (1.0 - np.cos(turn))
    # Both ends are kept where they are along the strip: without friction the upper layer would pull it open.
    ends = (along < 1e-9) | (along > along.max() - 1e-9)
    mask, places = sheet.supports.mask.copy(), sheet.supports.places.copy()
    mask[ends, 0], places[ends, 0] = 1, x[ends, 0]
    mask[along < 1e-9, 1], places[along < 1e-9, 1] = 1, x[along < 1e-9, 1]
    sheet.set_values(sheet.fabric, replace(sheet.supports, mask=mask, places=places), sheet.g)
    y, report, solver = sheet.flat(x), ConvergenceReport(), analysis.state.solver
    assert sheet.begin(y)
    solver.fall(y, 0.05, MOST, report)
    solver.converge(y, MOST, report)
    corners = sheet.corners(y)
    low = corners[(along > 0.05 * along.max()) & (along < 0.25 * along.max()), 2].mean()
    gap = corners[(along > 0.8 * along.max()) & (along < 0.95 * along.max()), 2].mean() - low
    height = (corners[:, 2].max() - low) / length
    crossed = len(sheet.surface.crossed(corners))
    source = "heavy elastica with contact, by shooting"
    return [
        Check("folded strip: height over (D/w)^(1/3)", height, loop_height(gap / length), 0.01, source, CLOSED_FORM),
        Check("folded strip: crossings", crossed, 0, 0, "nothing passes", CLOSED_FORM),
        Check("folded strip: rests", int(report.converged), 1, 0, "it is heavy", CLOSED_FORM),
    ]


@each_week(SLIPS=SLIPS[:2])
def two_sheets(comm: PETSc.Comm) -> list[Check]:
    """Whether a sheet on a fixed one stays, one per cent below and above the angle of friction.

    Where contact begins at more than a 20th of the mesh size nodes and edges catch on each other, and it slips later.
    """
    checks = []
    for mu, share, slips in SLIPS:
        for part, rests in ((0.99, 1), (slips, 0)):
            found = int(stays(mu, part * mu, comm, SHEET_SIZE / share))
            source = "Coulomb: it stays where tan(slope) < mu"
            what = f"sheet on sheet, mu = {mu:g}, thickness 1/{share} of mesh size, tan(slope) = {part:g} mu: rests"
            checks.append(Check(what, found, rests, 0, source, CLOSED_FORM))
    return checks


def stays(mu: float, slope: float, comm: PETSc.Comm, thickness: float, most: int = 300) -> bool:
    """Whether a sheet rests on a fixed one below it, whose slope has this tangent."""
    scene = first_frame(SCENES / "incline.toml", ["parameters.slope=0"], comm).analysis.problem
    mesh, above = stacked(scene.mesh)
    fixed = np.zeros((len(mesh.X), 3), np.uint8)
    fixed[~above] = 1
    x = np.column_stack([mesh.X, np.where(above, 0.6 * thickness, 0.0)])
    middle = mesh.X[~above].mean(axis=0)
    x[above, :2] += middle - mesh.X[above].mean(axis=0)
    g = 9.81 / np.hypot(1.0, slope) * np.array([slope, 0.0, -1.0])
    fabric = replace(scene.fabric, kind="none")
    sheet = ClothProblem(mesh, fabric, ClothSupports(fixed, x * fixed), g)
    weight = float(np.max(fabric.density)) * 9.81
    values = SelfContactValues(thickness, 2.0 * weight, mu, 1e-4)
    sheet.self_contact = SelfContact(CollisionSurface(mesh.X, mesh.cells), values)
    stages = Stages()
    traits = ClothProblem.traits(None)
    linear = LinearSolver(comm, "layers_linear_", "auto", 1e-4, Calibration.load(), stages, traits=traits)
    solver, report = EquilibriumSolver(sheet, comm, stages, linear, 1e-4, prefix="layers_"), ConvergenceReport()
    solver.converge(x, most, report)
    return report.converged


def stacked(mesh: Mesh) -> tuple[Mesh, np.ndarray]:
    """A mesh and, beside it in the pattern, a smaller turned one, and which nodes are of that."""
    centre, n, edges = mesh.X.mean(axis=0), len(mesh.X), len(mesh.edge_nodes)
    turn = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    beside = centre + 0.5 * (mesh.X - centre) @ turn + [2.0 * np.ptp(mesh.X[:, 0]), 0.0]
    both = replace(
        mesh,
        X=np.vstack([mesh.X, beside]),
        cells=np.vstack([mesh.cells, mesh.cells + n]).astype(mesh.cells.dtype),
        cell_edges=np.vstack([mesh.cell_edges, mesh.cell_edges + edges]).astype(mesh.cell_edges.dtype),
        edge_nodes=np.vstack([mesh.edge_nodes, mesh.edge_nodes + n]).astype(mesh.edge_nodes.dtype),
        node_offsets=np.array([0, 2 * n], np.int32),
        places=np.arange(2 * n),
        hierarchy=None,
    )
    return both, np.arange(2 * n) >= n
