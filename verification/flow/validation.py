"""Validation cases of flow: Kovasznay's, a driven cavity, a cylinder in a channel, steady and shedding eddies."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.stability.scenery import across, drag, make_replay, set_value, write_scene, write_script
from restshape_studies.validation.case import CLOSED_FORM, PUBLISHED, Case, Check
from restshape_verification.flow.scenes import CAVITY, CHANNEL, STEADY, ZONE, everywhere, forces, in_time, kovasznay

from restshape.fem.elements import MASS
from restshape.mesh.transfer import Transfer
from restshape.replay.first_frame import first_frame
from restshape.replay.loop import Replay

SPECTRAL = "spectral elements, whose last two orders differ by less than 2e-3; Botella and Peyret (1998) within 0.04 %"
CAVITIES = {100: (0.02, (-0.2140424, 0.1795728, -0.2538030)), 1000: (0.015, (-0.388580, 0.376963, -0.52689))}
"""By the Reynolds number: the size of the mesh; least u on the middle line, largest and least v."""
NABH = "G. Nabh, dissertation, Heidelberg (1998); M. Schaefer and S. Turek (1996), case 2D-1"
FEATFLOW = "FEATFLOW benchmark page, finest level, last period; M. Schaefer and S. Turek (1996), case 2D-2"
ROUNDED = 1e-10
"""Relative to the largest velocity; residuals are solved to 1e-11."""


def shown(text: str, comm: PETSc.Comm) -> Replay:
    """The replay of a scene's first shape."""
    with TemporaryDirectory() as folder:
        return first_frame(write_scene(Path(folder), text), [], comm)


def kovasznay_rate(comm: PETSc.Comm) -> list[Check]:
    """The order of the velocity behind a grid (Kovasznay), at Re = 40."""
    decay, found = 20.0 - np.sqrt(400.0 + 4.0 * np.pi**2), []
    for size in (0.05, 0.025, 0.0125):
        text = kovasznay(float(decay), 1 / 40) + f"[solve]\ntolerance = 1e-9\n[mesh]\nsize = {size!r}\n"
        analysis = shown(text, comm).analysis
        off = np.ascontiguousarray(analysis.x[:, :2] - _kovasznay(analysis.space.X, decay))
        space = analysis.space
        norm = np.sqrt(2.0 * MASS["tri3"].energy(space.X, off, space.cells, np.ones(1)).sum())
        found.append((len(space.cells) ** -0.5, norm))
    (coarse, first), *_, (fine, last) = np.log(np.array(found))
    source = "Kovasznay, Proc. Camb. Phil. Soc. 44 (1948) 58"
    return [Check("order of the velocity", float((last - first) / (fine - coarse)), 2.0, 0.05, source, CLOSED_FORM)]


def _kovasznay(X: np.ndarray, decay: float) -> np.ndarray:
    """The velocity (n, 2) at places (n, 2)."""
    e, y = np.exp(decay * X[:, 0]), 2 * np.pi * X[:, 1]
    return np.column_stack([1 - e * np.cos(y), decay / (2 * np.pi) * e * np.sin(y)])


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


def cylinder(comm: PETSc.Comm) -> list[Check]:
    """A cylinder in a channel at Re = 20: drag, lift, and what the pressure drops by."""
    mesh = "[mesh]\nsize = 0.006\nnear = { cylinder = 0.0007 }\n"
    row = shown(CHANNEL + STEADY + forces(0.2) + mesh, comm).row
    return [
        Check("drag coefficient", row["q_drag"], 5.57953523384, 0.01, NABH, PUBLISHED),
        # The lift is two thousandths of the drag: what a mesh without symmetry does to it falls slowly.
        Check("lift coefficient", row["q_lift"], 0.010618948146, 0.05, NABH, PUBLISHED),
        Check("pressure drop [Pa]", row["q_drop"], 0.11752016697, 0.005, NABH, PUBLISHED),
    ]


@each_week()
def street(comm: PETSc.Comm) -> list[Check]:
    """A cylinder in a channel at Re = 100: the frequency of its eddies, largest drag, and how far the lift goes."""
    mesh = "[mesh]\nsize = 0.03\nnear = { cylinder = 0.0025, zone = 0.011 }\n"
    text = CHANNEL.replace("U = 0.3", "U = 1.5") + ZONE + in_time(0.01) + forces(1.0) + mesh
    events = [{"do": "idle", "frames": 550}, *set_value("effects.flow.time_step", 0.003), {"do": "idle", "frames": 400}]
    with TemporaryDirectory() as folder:
        made = make_replay(write_scene(Path(folder), text), write_script(Path(folder), events))
        rows = [(row["q_drag"], row["q_lift"]) for row in made.frames()]
    largest, lift = np.array(rows[-230:]).T
    return [
        Check("Strouhal number", 0.1 / _period(lift, 0.003), 0.301841, 0.02, FEATFLOW, PUBLISHED),
        Check("largest drag coefficient", float(largest.max()), 3.227393, 0.02, FEATFLOW, PUBLISHED),
        Check("lift coefficient from peak to peak", float(np.ptp(lift)), 2.007871, 0.05, FEATFLOW, PUBLISHED),
    ]


def motion(comm: PETSc.Comm) -> list[Check]:
    """A uniform stream and a steady shear stay exact while a body in them is dragged, whatever the scheme."""
    path = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.65, 0.6), 6))
    checks = []
    for name, velocity, exact in (
        ("uniform stream", "[1, 0.3]", lambda X: np.broadcast_to([1.0, 0.3], X.shape)),
        ("shear", '["y", 0]', lambda X: np.column_stack([X[:, 1], 0.0 * X[:, 1]])),
    ):
        for scheme in ("bdf2", "backward_euler"):
            error = _dragged(everywhere(velocity, in_time(0.05, scheme)), path, exact)
            source = "solutions that are linear in space and do not change in time"
            checks.append(Check(f"largest error, {name}, {scheme} [m/s]", error, 0.0, ROUNDED, source, CLOSED_FORM))
    return checks


def _dragged(text: str, path: list[dict], exact: Callable[[np.ndarray], np.ndarray]) -> float:
    """The largest error of the velocity in the frames of a drag that begins with the exact one."""
    with TemporaryDirectory() as folder:
        made, worst = make_replay(write_scene(Path(folder), text), write_script(Path(folder), path)), 0.0
        for row in made.frames():
            analysis = made.analysis
            velocity = exact(analysis.space.X)
            if row["index"] == 0:
                analysis.begin(np.column_stack([velocity, np.zeros(len(velocity))]))
            worst = max(worst, float(np.abs(analysis.x[:, :2] - velocity).max()))
    return worst


def _period(lift: np.ndarray, dt: float) -> float:
    """The mean time between passages of 0 from below [s]."""
    up = np.flatnonzero((lift[:-1] < 0) & (lift[1:] >= 0))
    return float(np.diff(up + lift[up] / (lift[up] - lift[up + 1])).mean() * dt)


CASES: dict[str, Case] = {
    "kovasznay": kovasznay_rate,
    "cavity": cavity,
    "cylinder": cylinder,
    "street": street,
    "motion": motion,
}
