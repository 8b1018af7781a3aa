"""Which equations a scene makes, and which solvers they get, and why."""

from dataclasses import dataclass
from typing import Any

from restshape.scene.implied import LARGE, On
from restshape.scene.model import Scene

DEFINITE, INDEFINITE, UNSYMMETRIC = "symmetric positive definite", "symmetric indefinite", "unsymmetric"


@dataclass(frozen=True)
class System:
    """Linear systems of one kind.

    Args:
        of: what they give.
        matrix: "symmetric positive definite", "symmetric indefinite" or "unsymmetric".
        krylov: PETSc's KSP, beside a kept preconditioner; empty where eigenvalues are iterated for.
        factor: "cholesky" or "lu", where it is complete.
        why: for people.
    """

    of: str
    matrix: str
    krylov: str
    factor: str
    why: str


@dataclass(frozen=True)
class SolverPlan:
    """How the equations of a scene are solved.

    Args:
        equations: "linear", "nonlinear" or "eigenvalues".
        systems: the linear systems that are solved, those of the displacement first.
        why: the equations are of that kind.
    """

    equations: str
    systems: tuple[System, ...]
    why: str

    @property
    def symmetric(self) -> bool:
        """Whether the first of the systems is symmetric."""
        return self.systems[0].matrix != UNSYMMETRIC


def solver_plan(scene: Scene, on: On, settings: dict[str, Any]) -> SolverPlan:
    """The plan of a scene whose effects `on` are simulated, with the settings of each by name."""
    if "modal" in on:
        return _vibrations(settings["modal"])
    if "cloth" in on:
        return _drape(settings["drape"])
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
        return SolverPlan("linear", (displaced, pencil), f"{small}; load factors are eigenvalues of the state at rest")
    return SolverPlan("linear", (displaced,), f"{small}: one solve a frame")


def _displacement(scene: Scene, on: On, moving: bool) -> System:
    """The systems that the displacement comes from."""
    followers = [f"loads.{name}" for name, load in scene.loads.items() if load.pressure is not None]
    of = "Newton's steps" if LARGE in on else "displacement"
    if LARGE in on and followers:
        why = f"a pressure follows the boundary ({', '.join(followers)}): its forces have no potential"
        return System(of, UNSYMMETRIC, "gmres", "lu", why)
    held = "inertia and supports hold the body" if moving else "supports hold the body"
    why = f"all forces have a potential, and {held}"
    if LARGE in on and not moving:
        why += "; where stability is due the pivots of its factor tell"
    return System(of, DEFINITE, "cg", "cholesky", why)


def _vibrations(modal: Any) -> SolverPlan:
    """Free vibrations: K phi = lambda M phi."""
    why = "K - s M between eigenvalues: L D L^T, whose negative pivots count the modes below s"
    system = System("modes", INDEFINITE, "", "cholesky", why)
    return SolverPlan(
        "eigenvalues", (system,), f"free vibrations: the {modal.modes} lowest modes of K phi = lambda M phi"
    )


def _drape(drape: Any) -> SolverPlan:
    """Cloth that comes to rest: F(x) = 0, the gradient of an energy."""
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
        "L-BFGS on factors of the stabilised tangent, made anew every few steps",
    )
    newton = System(
        "Newton's steps", DEFINITE, "cg", "cholesky", "all forces have a potential, and cloth rests where it is least"
    )
    stabilised = System("Newton's steps", DEFINITE, "cg", "cholesky", "the stabilised tangent is positive definite")
    gradients = System("steps along gradients", DEFINITE, "", "", "nonlinear conjugate gradients solve no system")
    ways = {
        "auto": (
            (steps, descent, newton),
            "a soft membrane and kinetic damping where it starts anew, quasi-Newton steps, Newton's method at the end",
        ),
        "kinetic": ((steps,), "steps in time that begin anew at each peak of the kinetic energy"),
        "rayleigh": ((steps,), "steps in time with Rayleigh damping"),
        "newton": ((newton,), "Newton's method with a line search on the energy"),
        "stabilised": ((stabilised,), "Newton's method with the stabilised tangent and a line search on the energy"),
        "cg": ((gradients,), "nonlinear conjugate gradients on the energy"),
    }
    systems, how = ways[drape.way]
    return SolverPlan("nonlinear", systems, f"cloth moves far and turns: {how}")
