"""Validation of rasping: thickness place by place, and depths that lead to a tone, on slender bars."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.metallophone.rasping.advice import Way
from restshape_apps.metallophone.rasping.plan import RaspingPlan, Wish, rasping_plan
from restshape_apps.metallophone.rasping.underneath_places import WHOLE
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.metallophone.reference import solved

from restshape.sensitivity.thickness_density import thickness_density

BETA = 4.730040744862704
"""Of the first mode of a free bar: the smallest root of cosh b cos b = 1 above 0."""
LENGTH, HEIGHT, WIDTH = 0.2, 4e-4, 6e-3
SLENDER = [
    "effects.modal.model=plate",
    "effects.modal.modes=2",
    "material.aluminium.nu=0",
    f"material.aluminium.thickness={HEIGHT}",
    'mesh.size="2.5 mm"',
    "solve.tolerance=1e-6",
    *(f"shape.vertices.{name}=[{x}, {WIDTH}]" for name, x in (("c", LENGTH), ("d", 0.0))),
]
"""Overrides of the bar of 200 mm: thin and narrow, without lateral contraction."""


def rasping(comm: PETSc.Comm) -> list[Check]:
    """What the thickness of a slender free bar does in fifths of its length; depths off its ends, and off its face."""
    bar = solved("bar_200.toml", comm, SLENDER)
    found, f = thickness_density(bar, int(bar.state.modes.chosen[0])), float(bar.frequencies[0])
    fifth = np.minimum((5.0 * bar.space.X[:, 0] / LENGTH).astype(int), 4)
    euler = "Euler and Bernoulli: 3/2 of the bending energy less 1/2 of the kinetic one"
    checks = []
    for k, (what, share) in enumerate(zip(("end", "second", "middle"), shares())):
        inside = fifth == k
        mean = float((found.gradient[inside]).sum() / found.area[inside].sum() * found.area.sum())
        checks.append(Check(f"{what} fifth: h df/dh / f", mean * HEIGHT / f, 5.0 * share, 5e-3, euler, CLOSED_FORM))
    up = rasping_plan(bar, Wish(f, f * 2.0 ** (20.0 / 1200.0)))
    ends = _only(up, {"edge left", "edge right"})
    shorter = 0.5 * LENGTH * (1.0 - 2.0 ** (-20.0 / 2400.0))
    checks.append(
        Check("20 cents up, off each end [m]", float(ends.depths[0]), shorter, 1e-3, "f ~ 1/L^2", CLOSED_FORM)
    )
    down = rasping_plan(bar, Wish(f, f * 2.0 ** (-30.0 / 1200.0)))
    face = next(way for way in down.ways if way.places[0].where == WHOLE)
    thinner = HEIGHT * (1.0 - 2.0 ** (-30.0 / 1200.0))
    checks.append(Check("30 cents down, off the face [m]", float(face.depths[0]), thinner, 1e-3, "f ~ h", CLOSED_FORM))
    return checks


def shares() -> list[float]:
    """h df/dh / f of thickness in the first three fifths of a free bar: integrals of its first mode."""
    u = np.linspace(0.0, BETA, 50_001)
    ratio = (np.cosh(BETA) - np.cos(BETA)) / (np.sinh(BETA) - np.sin(BETA))
    deflection = np.cosh(u) + np.cos(u) - ratio * (np.sinh(u) + np.sin(u))
    curvature = np.cosh(u) - np.cos(u) - ratio * (np.sinh(u) - np.sin(u))
    rate = 1.5 * curvature**2 / np.mean(curvature**2) - 0.5 * deflection**2 / np.mean(deflection**2)
    return [float(rate[10_000 * k : 10_000 * (k + 1)].mean()) / 5.0 for k in range(3)]


def _only(plan: RaspingPlan, where: set[str]) -> Way:
    """The way that rasps these places alone."""
    return next(way for way in plan.ways if {place.where for place in way.places} == where)
