"""Flow in which no temperature differs from another: that of `physics.flow`, and one temperature everywhere."""

from collections.abc import Mapping

import numpy as np

from restshape.fem.observer import Function, Observer
from restshape.fem.problem import Fields
from restshape.fem.space import Space
from restshape.physics.flow.flow_quantities import flow_quantity, flux
from restshape.physics.flow.incompressible_flow import IncompressibleFlow
from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.physics.heated_flow.heated_flow_quantities import KINDS, isothermal_quantity
from restshape.physics.heated_flow.temperature_differences import neutral, uniform
from restshape.scene.model import Quantity


# More than 15 attributes: those of any flow.
class IsothermalFlow(IncompressibleFlow):
    """A flow without heat, which shows the one temperature of its scene; arguments as `IncompressibleFlow`."""

    def fields(self, x: np.ndarray) -> Fields:
        """Those of a flow at x (n, 3), and the temperature [K] of the nodes."""
        points, cells = super().fields(x)
        return {**points, "temperature": np.full(len(x), uniform(self.scene))}, cells

    @classmethod
    def blank_fields(cls, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on."""
        points, cells = super().blank_fields(space)
        return {**points, "temperature": np.full(len(space.X), np.nan)}, cells

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates quantities of the unknowns x (n, 3)."""
        return Observer({name: self._function(name, one) for name, one in quantities.items()})

    def _function(self, name: str, quantity: Quantity) -> Function:
        temperature = uniform(self.scene)
        if quantity.kind not in KINDS:
            return flow_quantity(self, name, quantity)
        warmer = temperature - neutral(self.scene)
        if quantity.kind != "heat_flow" or warmer == 0.0:
            return isothermal_quantity(temperature, name, quantity)
        out, (capacity, _) = flux(self, quantity.at), heat_properties(self.scene)
        return lambda x: capacity * warmer * out(x)
