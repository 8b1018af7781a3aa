"""Validation cases of bodies of triangles beside closed forms: friction, rest, and winding numbers."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.couture.body_files import ball, bar, slab, with_body
from restshape_verification.couture.validation_friction import AXIS, MOST, SCENES, slipping

from restshape import _kernels
from restshape.interface.first_frame import first_frame
from restshape.mesh.closed_surface import read_closed_surface

PLANE = 'plane = { point = [0.05, 0.05, -0.002], normal = ["sin(slope)", 0, "cos(slope)"] }'
ROUND = "sphere = { center = [0.05, 0.05, -0.202], radius = 0.2 }"
BAR = "capsule = { start = [0, -0.2, -0.052], end = [0, 0.22, -0.052], radius = 0.05 }"
PIECES = 120
"""Of the bar's circle: facets of 2.6 mm, which lie 0.017 mm within it."""


@each_week()
def incline_mesh(comm: PETSc.Comm) -> list[Check]:
    """Whether a patch on a slab of triangles stays, one per cent below and above the angle of friction."""
    checks, mu = [], 0.3
    body = 'spacing = "10 mm", move = [0.05, 0.05, -0.002], turn = [0, "slope", 0]'
    with TemporaryDirectory(prefix="restshape-slab-") as folder:
        path = with_body(SCENES / "incline.toml", PLANE, body, slab(0.2, 0.2, 0.1), Path(folder))
        for part, rests in ((0.99, 1), (1.01, 0)):
            slope = float(np.arctan(part * mu))
            row = first_frame(path, [f"parameters.slope={slope!r}", f"effects.drape.steps={MOST}"], comm).row
            # A slab has ends: what slips may come to rest over its rim.
            stays = int(row["converged"] == 1 and row["q_downhill"] < 1e-3)
            what = f"mu = {mu:g}, tan(slope) = {part:g} mu: rests where it was put"
            checks.append(Check(what, stays, rests, 0, "Coulomb: it stays where tan(slope) < mu", CLOSED_FORM))
    return checks


@each_week()
def capstan_mesh(comm: PETSc.Comm) -> list[Check]:
    """The ratio of its ends at which a strip over a bar of triangles slips."""
    body = f'spacing = "3 mm", move = [0, 0.01, {AXIS}]'
    with TemporaryDirectory(prefix="restshape-bar-") as folder:
        path = with_body(SCENES / "cylinder.toml", BAR, body, bar(0.05, 0.06, PIECES), Path(folder))
        return slipping(path, (0.0,), 0.03, comm)


@each_week()
def mesh_ball(comm: PETSc.Comm) -> list[Check]:
    """A patch at rest on balls of triangles and on the sphere: positions and energies."""
    settings = ["parameters.slope=0.0", "effects.contact.stiffness=6e4", "mesh.size=0.02"]
    found = {}
    with TemporaryDirectory(prefix="restshape-ball-") as folder:
        for pieces, spacing in ((0, 0.0), (10, 0.016), (20, 0.008)):
            path = Path(folder) / "incline.toml"
            path.write_text((SCENES / "incline.toml").read_text().replace(PLANE, ROUND))
            if pieces:
                body = f"spacing = {spacing}, move = [0.05, 0.05, -0.202]"
                with_body(path, ROUND, body, ball(0.2, pieces), Path(folder))
            first = first_frame(path, settings, comm)
            analysis = first.analysis
            found[pieces] = analysis.problem.corners(analysis.x), first.row["q_potential"], first.row["converged"]
    exact, energy, _ = found[0]
    off = {n: float(np.linalg.norm(found[n][0] - exact, axis=1).max()) for n in (10, 20)}
    wrong = {n: abs(found[n][1] / energy - 1.0) for n in (10, 20)}
    source = "the sphere; facets lie within it by the square of their size"
    return [
        Check("largest distance of a node, 8,000 triangles [m]", off[20], 0.0, 5e-4, source, CLOSED_FORM),
        Check("energy over the sphere's, 8,000 triangles", found[20][1] / energy, 1.0, 0.05, source, CLOSED_FORM),
        Check(
            "difference of energies, 8,000 over 2,000 triangles", wrong[20] / wrong[10], 0.25, 0.1, source, CLOSED_FORM
        ),
        Check("all three rest", float(min(one[2] for one in found.values())), 1.0, 0.0, source, CLOSED_FORM),
    ]


def winding(comm: PETSc.Comm) -> list[Check]:
    """Winding numbers by dipoles beside the sums of solid angles, and inside and outside of a bar by its sizes."""
    del comm
    with TemporaryDirectory(prefix="restshape-winding-") as folder:
        path = Path(folder) / "bar.obj"
        path.write_text(bar(0.05, 0.06, 60))
        surface = read_closed_surface(path, 1.0)
    search = _kernels.SurfaceSearch(surface.X, surface.cells)
    x = np.random.default_rng(0).uniform(-0.1, 0.1, (4000, 3))
    away = np.abs(search.nearest(x)[0]) > 1e-4
    out = np.hypot(x[:, 0], x[:, 2])
    sure = away & (np.abs(out - 0.05) > 1e-4)
    inside = (out < 0.05) & (np.abs(x[:, 1]) < 0.06)
    exact, fast = search.winding(x, np.inf), search.winding(x)
    off, missed = np.abs(exact - inside)[sure].max(), ((fast > 0.5) != inside)[sure].sum()
    apart, source = np.abs(fast - exact)[away].max(), "solid angles of van Oosterom and Strackee, summed"
    return [
        Check("sum of solid angles, off 1 and 0", float(off), 0.0, 1e-12, "1 inside, 0 outside", CLOSED_FORM),
        Check("dipoles, farthest off that sum", float(apart), 0.0, 0.01, source, CLOSED_FORM),
        Check("places on the wrong side", float(missed), 0.0, 0.0, "1 inside, 0 outside", CLOSED_FORM),
    ]
