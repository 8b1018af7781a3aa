"""What a fluid is to heat."""

from restshape.scene.model import Scene


def heat_properties(scene: Scene) -> tuple[float, float]:
    """Heat capacity by volume [J/(m^3 K)] and conductivity [W/(m K)] of the fluid of a scene.

    Of a fluid with a diffusivity alone they are 1 and that, and heat is counted in K m^3.
    """
    fluid = scene.fluid
    if fluid.diffusivity is None:
        return fluid.rho * fluid.heat_capacity, fluid.conductivity
    if fluid.conductivity is None:
        return 1.0, fluid.diffusivity
    return fluid.conductivity / fluid.diffusivity, fluid.conductivity
