"""Which equations cloth makes, and which solvers they get, and why."""

from collections.abc import Mapping
from typing import Any

from restshape.scene.derived_effects import On
from restshape.scene.model import Scene
from restshape.scene.solver import DEFINITE, SolverPlan, System


def cloth_plan(scene: Scene, on: On, settings: Mapping[str, Any]) -> SolverPlan:
    """The plan of cloth that is relaxed to equilibrium: F(x) = 0, the gradient of an energy."""
    steps = System(
        "steps in time",
        DEFINITE,
        "cg",
        "",
        "M/dt^2 + K with the stabilised tangent, whose membrane is never in compression",
    )
    descent = System(
        "quasi-Newton steps",
        DEFINITE,
        "",
        "cholesky",
        "L-BFGS on factors of the stabilised tangent, refreshed every few steps",
    )
    newton = System(
        "Newton's steps", DEFINITE, "cg", "cholesky", "all forces have a potential, and cloth rests where it is least"
    )
    stabilised = System("Newton's steps", DEFINITE, "cg", "cholesky", "the stabilised tangent is positive definite")
    gradients = System("steps along gradients", DEFINITE, "", "", "nonlinear conjugate gradients solve no system")
    ways = {
        "auto": (
            (steps, descent, newton),
            "implicit steps with kinetic damping at a cold start, quasi-Newton steps, Newton's method at the end",
        ),
        "kinetic": ((steps,), "steps in time that restart at each peak of the kinetic energy"),
        "rayleigh": ((steps,), "steps in time with Rayleigh damping"),
        "newton": ((newton,), "Newton's method with a line search on the energy"),
        "stabilised": ((stabilised,), "Newton's method with the stabilised tangent and a line search on the energy"),
        "cg": ((gradients,), "nonlinear conjugate gradients on the energy"),
    }
    systems, how = ways[settings["drape"].strategy]
    return SolverPlan("nonlinear", systems, f"cloth moves far and turns: {how}")
