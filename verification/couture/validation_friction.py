"""Validation cases of friction: a patch on an incline, and a strip over a bar."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import CLOSED_FORM, Check
from scipy.optimize import brentq

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.contact.contact import FrictionHistory
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport

SCENES = application("couture").folder / "scenes"
THIN = 0.5e-3
"""Distance [m] at which contact with the bar begins: what tension presses in is little beside the bar's radius."""
AXIS = -0.05 - THIN
MOST = 400
"""Steps after which cloth that is not in equilibrium slides."""
COEFFICIENTS = (0.3, 0.8)
"""Of friction on the incline."""
SHIFTS = (0.0, 0.02)
"""How far the middle of the strip over the bar is off [m], which makes ratios of its ends."""


@each_week(COEFFICIENTS=COEFFICIENTS[:1])
def incline(comm: PETSc.Comm) -> list[Check]:
    """Whether a patch on an incline stays, one per cent below and above the angle of friction."""
    checks = []
    for mu in COEFFICIENTS:
        for part, rests in ((0.99, 1), (1.01, 0)):
            slope = float(np.arctan(part * mu))
            settings = [f"parameters.slope={slope!r}", f"bodies.ground.friction={mu}", f"effects.drape.steps={MOST}"]
            row = first_frame(SCENES / "incline.toml", settings, comm).row
            source = "Coulomb: it stays where tan(slope) < mu"
            what = f"mu = {mu:g}, tan(slope) = {part:g} mu: rests"
            checks.append(Check(what, row["converged"], rests, 0, source, CLOSED_FORM))
    return checks


@dataclass(frozen=True)
class Hung:
    """How a strip hangs over the bar: lengths [m] of its shorter and its longer end, and the radius [m] it lies at."""

    short: float
    long: float
    radius: float

    def most(self, mu: float) -> float:
        """The ratio of both lengths at which the strip slips: T' = mu (T + w R sin a) + w R cos a around the bar."""
        around = np.exp(mu * np.pi)
        return float(around + 2 * mu * self.radius / ((1 + mu * mu) * self.short) * (1 + around))

    @property
    def ratio(self) -> float:
        """Of both lengths."""
        return self.long / self.short

    def friction(self, part: float) -> float:
        """The coefficient with which this strip has that part of the ratio at which it slips."""
        return brentq(lambda mu: self.most(mu) - self.ratio / part, 1e-4, 3.0)


def hung(analysis: RelaxationAnalysis) -> Hung:
    """How the strip hangs: material below the axis of the bar, and the mean distance of what lies on it."""
    sheet, along = analysis.problem, analysis.problem.mesh.X[:, 0]
    x = sheet.corners(analysis.x)
    height = x[:, 2] - AXIS
    ends = []
    for side in (-1.0, 1.0):
        near = (side * x[:, 0] > 0) & (np.abs(height) < 0.012)
        crossing = np.polyfit(height[near], along[near], 1)[1]
        ends.append(abs((along.min() if side < 0 else along.max()) - crossing))
    return Hung(ends[0], ends[1], float(np.hypot(x[:, 0], height)[height > 0].mean()))


def rests(analysis: RelaxationAnalysis, mu: float, x: np.ndarray, history: FrictionHistory) -> bool:
    """Whether the strip stays with another coefficient of friction, from where it lay with a larger one."""
    analysis.x[:] = x
    analysis.problem.contact.history = history
    analysis.problem.contact.friction = np.array([mu])
    return analysis.state.solver.converge(analysis.x, MOST, ConvergenceReport()).converged


@each_week(SHIFTS=SHIFTS[1:])
def capstan(comm: PETSc.Comm) -> list[Check]:
    """The ratio of its ends at which a strip over a bar slips, in a bracket that is halved, for two ratios."""
    bar = [f"bodies.bar.capsule.{end}=[0,{y},{AXIS}]" for end, y in (("start", -0.2), ("end", 0.22))]
    return slipping(SCENES / "cylinder.toml", SHIFTS, 0.01, comm, bar)


def slipping(
    scene: Path, shifts: Sequence[float], tolerance: float, comm: PETSc.Comm, bar: Sequence[str] = ()
) -> list[Check]:
    """The same of a scene with a bar.

    Args:
        scene: of a strip over it.
        shifts: of the strip's middle [m].
        tolerance: of both ends of the bracket, and its width.
        comm: that it runs on.
        bar: settings that place the bar.
    """
    checks = []
    for shift in shifts:
        analysis = placed(scene, shift, comm, bar)
        start, x, history = hung(analysis), analysis.x.copy(), analysis.problem.contact.history
        low, high, best = 0.95, 1.06, 0.0
        while high - low > tolerance:
            middle = 0.5 * (low + high)
            mu = start.friction(middle)
            if rests(analysis, mu, x, history):
                # It has crept a little on the way: what counts is how it hangs now.
                now = hung(analysis)
                low, best = middle, max(best, now.ratio / now.most(mu))
            else:
                high = middle
        source = "capstan with weight: L2 = L1 e^(mu pi) + 2 mu R (1 + e^(mu pi))/(1 + mu^2)"
        what = f"over a bar, L2/L1 = {start.ratio:.2f}"
        checks += [
            Check(f"{what}: largest ratio that rests, over the exact one", best, 1.0, tolerance, source, CLOSED_FORM),
            Check(f"{what}: smallest that slips, over the exact one", high, 1.0, tolerance, source, CLOSED_FORM),
        ]
    return checks


def placed(scene: Path, shift: float, comm: PETSc.Comm, bar: Sequence[str]) -> RelaxationAnalysis:
    """A strip without bending in equilibrium over a rough bar, its middle off by some length [m] more than in the
    scene."""
    vertices = [f"shape.vertices.{v}=[{x + shift},{y}]" for v, x, y in (("a", -0.18, 0), ("b", 0.28, 0))]
    vertices += [f"shape.vertices.{v}=[{x + shift},{y}]" for v, x, y in (("c", 0.28, 0.02), ("d", -0.18, 0.02))]
    settings = ["bodies.bar.friction=3", f"effects.contact.thickness={THIN}", "effects.cloth.bending=none"]
    return first_frame(scene, [*vertices, *bar, *settings], comm).analysis
