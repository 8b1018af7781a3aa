"""Small scenes of cloth for hard cases, and measures of what rests in them that the solver does not make."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from restshape_studies.stability.case import Row, Statement, Trial, below, true, valid
from restshape_studies.stability.scenery import block, meshed, rows_of

from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.replay.loop import Replay

REST = 1e-4
"""Residual over weight at which cloth rests: the default of a scene."""
WAY = 2e-7
"""Half of the distance [m] between two energies whose difference is a force."""
SAMPLES = 16
"""Parts of a triangle's side between whose ends it is looked at."""
HEAD = """format = "restshape-scene"
version = 1
app = "couture"
"""
COTTON = """
[material.cotton]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
bending = "{bending} N m"
"""
GRAVITY = "\n[effects.gravity]\n"
CONTACT = "\n[effects.contact]\n"
QUANTITIES = """
[quantities]
lowest = { displacement = "z", reduce = "min" }
highest = { displacement = "z", reduce = "max" }
bent = { energy = "bending" }
stretched = { energy = "membrane" }
potential = { energy = "potential" }
"""
BALL = """
[bodies.ball]
sphere = {{ center = [{x}, {y}, {z}], radius = {radius} }}
friction = {friction}
"""
FLOOR = """
[bodies.floor]
plane = {{ point = [0, 0, {z}], normal = [0, 0, 1] }}
friction = 0.3
"""


def cloth(kind: str = "hinge") -> str:
    """The [effects.cloth] with a kind of bending."""
    return f'\n[effects.cloth]\nbending = "{kind}"\n'


def cotton(bending: float = 5e-6) -> str:
    """The material of a shirt, with another bending stiffness [N m]."""
    return COTTON.format(bending=bending)


def pinned(*names: str, fix: str = '["x", "y", "z"]') -> str:
    """Supports that hold corners or edges."""
    return "".join(f'\n[supports.{name}]\non = "{name}"\nfix = {fix}\n' for name in names)


def ball(x: float, y: float, radius: float = 0.1, friction: float = 0.3, clearance: float = 2e-3) -> str:
    """A ball below the plane z = 0, which it all but touches."""
    return BALL.format(x=x, y=y, z=-radius - clearance, radius=radius, friction=friction)


def floor(z: float) -> str:
    """A rough floor at a height [m]."""
    return FLOOR.format(z=z)


def start(scatter: float = 0.0, seed: int = 0, move: Sequence[float] = (0, 0, 0)) -> str:
    """Where cloth lies before it falls."""
    return f"\n[start]\nscatter = {scatter}\nseed = {seed}\nmove = {list(move)}\n"


def square(
    size: float, *parts: str, side: float = 0.3, height: float | None = None, kind: str = "hinge", bending: float = 5e-6
) -> str:
    """A scene of a rectangle of cotton under gravity, with a mesh of a size [m] and further tables."""
    shape = block(side, side if height is None else height)
    return HEAD + shape + cotton(bending) + cloth(kind) + GRAVITY + meshed(size) + QUANTITIES + "".join(parts)


def played(trial: Trial, text: str, events: Sequence[dict[str, Any]] = (), **more: Any) -> tuple[Replay, list[Row]]:
    """A replay that has ended, and its rows."""
    run = trial.replay(text, events, **more)
    return run.replay, rows_of(run)


def differenced(made: Replay, most: int = 600, way: float = WAY) -> float:
    """The residual forces over the weight, by central differences of the energy at the present positions.

    Args:
        made: a replay.
        most: unknowns that are looked at, drawn at random; the norm stands for all.
        way: half of the distance between two energies [m].
    """
    sheet, x = made.analysis.problem, made.analysis.x.copy()
    free = np.flatnonzero(sheet.boundary.free.ravel())
    chosen = np.random.default_rng(0).permutation(free)[:most]
    flat, forces = x.ravel(), []
    for unknown in chosen:
        kept = flat[unknown]
        flat[unknown] = kept + way
        after = sheet.energy(x)
        flat[unknown] = kept - way
        forces.append((after - sheet.energy(x)) / (2 * way))
        flat[unknown] = kept
    return float(np.linalg.norm(forces)) * (len(free) / len(chosen)) ** 0.5 / made.analysis.state.solver.scale(x)


def resting(made: Replay, rows: Sequence[Row], bound: float = REST, way: float = WAY) -> Iterator[Statement]:
    """The statements that every frame is converged, and the last one by differences of the energy over a way [m],
    too."""
    yield from valid(rows, residual=bound)
    moving = [row for row in rows if not row["converged"]]
    yield true(f"{len(rows)} frames in equilibrium", not moving, moving[0]["note"] if moving else "yes")
    # Differences have an error of rounding and of the third derivative besides, and a residual that few unknowns have
    # is overestimated by up to twice where some of them are drawn.
    yield below("residual by differences of the energy", differenced(made, way=way), 3.0 * bound)


def samples(made: Replay) -> np.ndarray:
    """Places (n, 3) [m] all over the triangles, as they lie now."""
    analysis = made.analysis
    corners = analysis.problem.corners(analysis.x)[analysis.problem.mesh.cells]
    i, j = (part.ravel() for part in np.mgrid[: SAMPLES + 1, : SAMPLES + 1])
    inside = np.column_stack([i, j, SAMPLES - i - j])[i + j <= SAMPLES] / SAMPLES
    return np.einsum("pk,eka->epa", inside, corners).reshape(-1, 3)


def depth(made: Replay) -> float:
    """How deep the deepest of many places of the triangles is in a body [m]."""
    places = samples(made)
    return max(float(-body.distances(places).min()) for body in made.analysis.problem.contact.bodies)


def outside(made: Replay, bound: float) -> Statement:
    """The statement that no place of a triangle is deeper in a body than a bound [m]."""
    return below("depth of a triangle in a body [m]", depth(made), bound)


def turned_over(made: Replay) -> float:
    """The part of the triangles of the start that are turned over, seen from above."""
    analysis = made.analysis
    scene, mesh = analysis.state.scene, analysis.space
    x = InitialPlacement(scene).scattered(mesh)[:, :2]
    a, b, c = x[mesh.corners].swapaxes(0, 1)
    u, v = b - a, c - a
    return float(np.mean(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] < 0))
