"""What the physics give to analyses: all that `Problem` or, for free vibrations, the narrower `Eigenproblem` names."""

import dis
import inspect

import pytest

from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.problem import Problem, TransientProblem
from restshape.physics.cloth.problem import ClothProblem
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.physics.elasticity.prestressed_solid import PrestressedSolid
from restshape.physics.elasticity.vibrating_plane import VibratingPlane
from restshape.physics.elasticity.vibrating_solid import VibratingSolid
from restshape.physics.plates.vibrating_plate import VibratingPlate

# Cloth is loaded by weight and contact alone, which are internal; what it is made of comes without its scene.
OF_LOADS = {
    "load_steps",
    "loaded",
    "loaded_inside",
    "add_nodal_loads",
    "add_nodal_load_rates",
    "objection",
    "scene",
    "cell_scalars",
}


def members(protocol: type) -> set[str]:
    """Names that a protocol asks for."""
    bases = [base for base in protocol.__mro__ if getattr(base, "_is_protocol", False)]
    named = {name for base in bases for name in (*vars(base), *vars(base).get("__annotations__", {}))}
    return {name for name in named if not name.startswith("_")}


def given(made: type) -> set[str]:
    """Names that objects of a class have: of the class, of its annotations, and those that its methods set."""
    found = set(dir(made))
    for base in made.__mro__:
        found |= set(vars(base).get("__annotations__", {}))
        methods = [value for value in vars(base).values() if inspect.isfunction(value)]
        found |= {
            step.argval for method in methods for step in dis.get_instructions(method) if step.opname == "STORE_ATTR"
        }
    return found


@pytest.mark.parametrize(
    "made, protocol, without",
    [
        (PlaneSolid, TransientProblem, set()),
        (PrestressedSolid, TransientProblem, set()),
        (ClothProblem, Problem, OF_LOADS),
        (VibratingPlane, Eigenproblem, set()),
        (VibratingSolid, Eigenproblem, set()),
        (VibratingPlate, Eigenproblem, set()),
    ],
)
def test_physics_give_what_the_protocol_names(made, protocol, without):
    assert members(protocol) - given(made) == without
