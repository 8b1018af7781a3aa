"""Which equations elastic solids make, and which solvers they get, and why."""

from collections.abc import Mapping
from typing import Any

from restshape.physics.elasticity.elasticity_derived_effects import LARGE
from restshape.scene.derived_effects import On
from restshape.scene.model import Scene
from restshape.scene.solver import DEFINITE, INDEFINITE, UNSYMMETRIC, SolverPlan, System


def solid_plan(scene: Scene, on: On, settings: Mapping[str, Any]) -> SolverPlan:
    """The plan of solids, static or in motion."""
    moving = "dynamics" in on
    displaced = _displacement(scene, on, moving)
    if LARGE in on:
        each = "in each time step" if moving else "in each frame, by steps of load where it does not reach"
        return SolverPlan("nonlinear", (displaced,), f"large deformation is on: Newton's method {each}")
    small = "strains are small and loads keep their direction"
    if moving:
        return SolverPlan("linear", (displaced,), f"{small}: one matrix for all time steps of a frame")
    if "buckling" in on:
        pencil = System(
            "load factors",
            INDEFINITE,
            "",
            "cholesky",
            "the load takes stiffness away, K + mu G: L D L^T, whose negative pivots count the load factors below mu",
        )
        return SolverPlan(
            "linear", (displaced, pencil), f"{small}; load factors are eigenvalues of the state of equilibrium"
        )
    return SolverPlan("linear", (displaced,), f"{small}: one solve a frame")


def _displacement(scene: Scene, on: On, moving: bool) -> System:
    """The systems that the displacement comes from."""
    followers = [f"loads.{name}" for name, load in scene.loads.items() if load.pressure is not None]
    of = "Newton's steps" if LARGE in on else "displacement"
    if LARGE in on and followers:
        why = f"a pressure follows the boundary ({', '.join(followers)}): its forces have no potential"
        return System(of, UNSYMMETRIC, "gmres", "lu", why)
    why_stable = "inertia and supports hold the body" if moving else "supports hold the body"
    why = f"all forces have a potential, and {why_stable}"
    if LARGE in on and not moving:
        why += "; where stability is due it follows from the pivots of its factor"
    return System(of, DEFINITE, "cg", "cholesky", why)


def vibration_plan(scene: Scene, on: On, settings: Mapping[str, Any]) -> SolverPlan:
    """The plan of free vibrations: K phi = lambda M phi."""
    why = "K - s M between eigenvalues: L D L^T, whose negative pivots count the modes below s"
    system = System("modes", INDEFINITE, "", "cholesky", why)
    modes = settings["modal"].modes
    return SolverPlan("eigenvalues", (system,), f"free vibrations: the {modes} lowest modes of K phi = lambda M phi")
