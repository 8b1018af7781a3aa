"""Which equations furniture makes, and which solver they get, and why."""

from typing import Any

from restshape.scene.derived_effects import On
from restshape.scene.model import Scene
from restshape.scene.solver import INDEFINITE, SolverPlan, System


def solver_plan(scene: Scene, on: On, settings: dict[str, Any]) -> SolverPlan:
    """The plan of planks on springs: displacements and forces of joints at once."""
    why = "forces of joints are unknowns beside displacements: the mixed form stays well conditioned for stiff joints"
    system = System("Newton's steps", INDEFINITE, "preonly", "lu", why)
    contacts = "contacts push and rub, and joints turn with their planks"
    return SolverPlan("nonlinear", (system,), f"{contacts}: Newton's method")
