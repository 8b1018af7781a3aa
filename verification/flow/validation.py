"""Validation cases of flow: a driven cavity, a cylinder in a channel, steady and shedding eddies, exact flows."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.stability.scenery import across, drag, make_run, set_value, write_scene, write_script
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, PUBLISHED, Case, Check
from restshape_verification.flow.mirrored_channel import write_mesh
from restshape_verification.flow.scenes import (
    CAVITY,
    CHANNEL,
    STEADY,
    SYMMETRIC_CHANNEL,
    ZONE,
    channel,
    disc,
    everywhere,
    forces,
    in_time,
)
from restshape_verification.flow.shown import played, shown
from restshape_verification.flow.validation_derivatives import force_derivatives
from restshape_verification.flow.validation_orders import kovasznay_rates, vortices_in_space, vortices_in_time

from restshape.interface.first_frame import first_frame
from restshape.mesh.transfer import Transfer

SPECTRAL = "spectral elements, whose last two orders differ by less than 2e-3; Botella and Peyret (1998) within 0.04 %"
CAVITIES = {100: (0.02, (-0.2140424, 0.1795728, -0.2538030)), 1000: (0.015, (-0.388580, 0.376963, -0.52689))}
"""By the Reynolds number: the size of the mesh; least u on the middle line, largest and least v."""
NABH = "G. Nabh, dissertation, Heidelberg (1998); M. Schaefer and S. Turek (1996), case 2D-1"
FEATFLOW = "FEATFLOW benchmark page, finest level, last period; M. Schaefer and S. Turek (1996), case 2D-2"
CYLINDER_SIZES = (0.014, 0.009, 0.007)
"""Sizes of the mesh; a tenth at the cylinder, half behind it [m]."""
SETTLED = 150
"""Frames after which a flow at rest again is steady."""
LAST = 0.0015
"""The time step with which a street is measured [s]."""
ROUNDED = 1e-10
"""Relative to the largest velocity; residuals are solved to 1e-11."""


def cavity(comm: PETSc.Comm) -> list[Check]:
    """A lid-driven cavity at Re = 100 and 1000: extremes of the velocity on the middle lines."""
    checks, s = [], np.linspace(0.0, 1.0, 4001)
    names = ("least u at x = 1/2", "largest v at y = 1/2", "least v at y = 1/2")
    for reynolds, (size, published) in CAVITIES.items():
        text = CAVITY.replace("Re = 100", f"Re = {reynolds}") + STEADY + f"[mesh]\nsize = {size!r}\n"
        analysis = shown(text, comm).analysis
        middle = np.full_like(s, 0.5)
        u = Transfer(analysis.space, np.column_stack([middle, s]))(analysis.x)[:, 0]
        v = Transfer(analysis.space, np.column_stack([s, middle]))(analysis.x)[:, 1]
        for name, value, known in zip(names, (u.min(), v.max(), v.min()), published):
            checks.append(Check(f"{name}, Re = {reynolds} [m/s]", float(value), known, 0.005, SPECTRAL, PUBLISHED))
    return checks


@each_week(CYLINDER_SIZES=CYLINDER_SIZES[:1])
def cylinder(comm: PETSc.Comm) -> list[Check]:
    """A cylinder in a channel at Re = 20: drag, lift, and what the pressure drops by, on symmetric meshes."""
    checks = []
    for size in CYLINDER_SIZES:
        mesh = f"[mesh]\nsize = {size!r}\nnear = {{ cylinder = {0.1 * size!r}, zone = {0.5 * size!r} }}\n"
        with TemporaryDirectory() as folder:
            write_mesh(Path(folder) / "channel.msh", mesh, comm)
            made = first_frame(write_scene(Path(folder), SYMMETRIC_CHANNEL + STEADY + forces(0.2)), [], comm)
        analysis, row = made.analysis, made.row
        ends = Transfer(analysis.space, np.array([[0.15, 0.2], [0.25, 0.2]]))(analysis.x)[:, 2]
        on = f"{len(analysis.space.cells)} triangles"
        checks += [
            Check(f"drag coefficient, {on}", row["q_drag"], 5.57953523384, 0.01, NABH, PUBLISHED),
            Check(f"lift coefficient, {on}", row["q_lift"], 0.010618948146, 0.01, NABH, PUBLISHED),
            Check(f"pressure drop, {on} [Pa]", float(ends[0] - ends[1]), 0.11752016697, 0.005, NABH, PUBLISHED),
        ]
    return checks


@each_week()
def street(comm: PETSc.Comm) -> list[Check]:
    """A cylinder in a channel at Re = 100: the frequency of its eddies, largest drag, and how far the lift goes."""
    mesh = "[mesh]\nsize = 0.018\nnear = { cylinder = 0.0006, zone = 0.0033 }\n"
    text = CHANNEL.replace("U = 0.3", "U = 1.5") + ZONE + in_time(0.01) + forces(1.0) + mesh
    events = [{"do": "idle", "frames": 400}]
    # Long steps until there are eddies, then such as resolve them.
    for time_step, frames in ((0.004, 250), (LAST, 700)):
        events += [*set_value("effects.flow.time_step", time_step), {"do": "idle", "frames": frames}]
    with TemporaryDirectory() as folder:
        run = make_run(write_scene(Path(folder), text), write_script(Path(folder), events))
        rows = [(row["q_drag"], row["q_lift"], row["q_street"]) for row in run.rows()]
    # A period is a third of a second.
    largest, lift, (*_, number) = np.array(rows[-round(0.4 / LAST) :]).T
    return [
        Check("Strouhal number", float(number), 0.301841, 0.02, FEATFLOW, PUBLISHED),
        Check("largest drag coefficient", float(largest.max()), 3.227393, 0.02, FEATFLOW, PUBLISHED),
        Check("lift coefficient from peak to peak", float(np.ptp(lift)), 2.007871, 0.02, FEATFLOW, PUBLISHED),
    ]


def motion(comm: PETSc.Comm) -> list[Check]:
    """A uniform stream and a steady shear stay exact while a body in them is dragged, through flips and new meshes."""
    path = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.75, 0.75), 30))
    checks = []
    for name, velocity, exact in (("uniform stream", "[1, 0.3]", uniform), ("shear", '["y", 0]', shear)):
        for scheme, carry in (("bdf2", "ale"), ("backward_euler", "ale"), ("bdf2", "remap")):
            error = max(played(everywhere(velocity, in_time(0.05, scheme, carry=carry)), path, exact))
            source = "solutions that are linear in space and do not change in time"
            what = f"largest error, {name}, {scheme}, {carry} [m/s]"
            checks.append(Check(what, error, 0.0, ROUNDED, source, CLOSED_FORM))
    return checks


def brought_back(comm: PETSc.Comm) -> list[Check]:
    """A body that is dragged away and brought back has the forces that it had, in steady flow."""
    asked = '[quantities]\ndrag = { drag = true, at = "body" }\n[solve]\ntolerance = 1e-9\n'
    mesh = "[mesh]\nsize = 0.1\nnear = { body = 0.04 }\n"
    text = channel(3, 1, "rho = 1.5\nmu = 0.1\n", holes=disc("body", (1.0, 0.5), 0.15)) + STEADY + asked + mesh
    path = [*across((1.0, 0.5), (1.2, 0.56), 3), *across((1.2, 0.56), (1.0, 0.5), 3)]
    with TemporaryDirectory() as folder:
        run = make_run(write_scene(Path(folder), text), write_script(Path(folder), drag("body", (1.0, 0.5), path)))
        forces = [row["q_drag"] for row in run.rows()]
    checks = [
        Check("drag of a body that is brought back [N]", forces[-1], forces[0], 1e-10, "the same shape", IDENTITY)
    ]
    # In time what the motion brought about must die away first.
    timed = text.replace(STEADY, in_time(0.2)).replace(
        "[quantities]", "[quantities]\nlift = { lift = true, at = 'body' }"
    )
    still, moved = (_last_forces(timed, events) for events in ([_idle(6)], drag("body", (1.0, 0.5), path)))
    for name, now, was in zip(("drag", "lift"), moved, still):
        what = f"{name} of a body that is brought back, in time, over the drag"
        checks.append(
            Check(what, 1.0 + (now - was) / still[0], 1.0, 1e-10, "the flow of one that never moved", IDENTITY)
        )
    return checks


def _idle(frames: int) -> dict[str, object]:
    return {"do": "idle", "frames": frames}


def _last_forces(text: str, events: list[dict[str, object]]) -> tuple[float, float]:
    """Drag and lift [N] of the body long after a script."""
    with TemporaryDirectory() as folder:
        run = make_run(write_scene(Path(folder), text), write_script(Path(folder), [*events, _idle(SETTLED)]))
        *_, last = ((row["q_drag"], row["q_lift"]) for row in run.rows())
    return last


def uniform(X: np.ndarray, time: float) -> np.ndarray:
    """Velocity and pressure (n, 3) of a uniform stream at places (n, 2)."""
    return np.broadcast_to([1.0, 0.3, 0.0], (len(X), 3))


def shear(X: np.ndarray, time: float) -> np.ndarray:
    """Velocity and pressure (n, 3) of a shear (y, 0) at places (n, 2)."""
    return np.column_stack([X[:, 1], np.zeros((len(X), 2))])


CASES: dict[str, Case] = {
    "kovasznay": kovasznay_rates,
    "cavity": cavity,
    "cylinder": cylinder,
    "street": street,
    "motion": motion,
    "brought_back": brought_back,
    "vortices_in_space": vortices_in_space,
    "vortices_in_time": vortices_in_time,
    "derivatives": force_derivatives,
}
