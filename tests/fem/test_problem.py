"""What the physics give to analyses: all that `SteadyProblem` or, of free vibrations, `Eigenproblem` names."""

import dis
import inspect

import pytest

from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.problem import SteadyProblem, TransientProblem
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.physics.elasticity.prestressed_solid import PrestressedSolid
from restshape.physics.elasticity.vibrating_plane import VibratingPlane
from restshape.physics.elasticity.vibrating_solid import VibratingSolid
from restshape.physics.plates.vibrating_plate import VibratingPlate

DEFAULTS = {
    "backend",
    "load_steps",
    "loaded",
    "add_nodal_loads",
    "add_nodal_load_rates",
    "share",
    "objection",
    "linear_displacement",
    "energy_moduli",
    "initial",
    "name_in_time",
    "accounts_energy",
    "traits",
    "blank_fields",
    "cell_scalars",
    "definite",
    "nested",
    "rigid_motions",
    "start",
}
"""What a problem may inherit from the protocol as it stands there."""


def members(protocol: type) -> set[str]:
    """Names that a protocol asks for."""
    bases = [base for base in protocol.__mro__ if getattr(base, "_is_protocol", False)]
    named = {name for base in bases for name in (*vars(base), *vars(base).get("__annotations__", {}))}
    return {name for name in named if not name.startswith("_")}


def given(made: type) -> set[str]:
    """Names that objects of a class have: of the class, of its annotations, and those that its methods set."""
    found = set(DEFAULTS)
    for base in (base for base in made.__mro__ if not getattr(base, "_is_protocol", False)):
        found |= set(vars(base))
        found |= set(vars(base).get("__annotations__", {}))
        methods = [value for value in vars(base).values() if inspect.isfunction(value)]
        found |= {
            step.argval for method in methods for step in dis.get_instructions(method) if step.opname == "STORE_ATTR"
        }
    return found


@pytest.mark.parametrize(
    "made, protocol",
    [
        (PlaneSolid, TransientProblem),
        (PrestressedSolid, TransientProblem),
        (ClothProblem, SteadyProblem),
        (VibratingPlane, Eigenproblem),
        (VibratingSolid, Eigenproblem),
        (VibratingPlate, Eigenproblem),
    ],
)
def test_physics_give_what_the_protocol_names(made, protocol):
    assert members(protocol) - (given(made) - DEFAULTS) <= DEFAULTS
