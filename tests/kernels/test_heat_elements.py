"""Elements of conduction: consistent energy, residual, tangent and design derivative; what flows and what is stored."""

import numpy as np
import pytest
from element_case import TRI3, ElementCase, curved

SIDE = np.array([[0.1, 0.0], [1.2, 0.2]])


class HeatCase(ElementCase):
    """The checks of any element, and that temperatures only matter by their differences."""

    free = True

    def test_a_uniform_temperature_flows_nowhere(self, element):
        warm = np.full((element.nodes, 1), 3.0)
        change = self.residual(element, self.X, warm) - self.residual(element, self.X, 0 * warm)
        assert np.allclose(change, 0.0, atol=1e-12) == self.free


class TestConductionTri3(HeatCase):
    name, params, X = "conduction_tri3", (1.3, 0.2, 0.7), TRI3


class TestConductionTri6(HeatCase):
    name, params, X = "conduction_tri6", (1.3, 0.2, 0.7, 0.4, -0.5), curved(TRI3)

    def test_a_linear_temperature_has_one_flux(self, element):
        x = (self.X @ [2.0, -0.5])[:, None]
        out = np.empty((1, 3, 2))
        element.stress(self.X, x, self.cells, self.p, out, np.array([[0.1, 0.2], [0.6, 0.3], [1 / 3, 1 / 3]]))
        np.testing.assert_allclose(out[0], [[-2.6, 0.65]] * 3, atol=1e-12)


class TestHeatCapacityTri3(HeatCase):
    name, params, X, free = "heat_capacity_tri3", (2.5,), TRI3, False


class TestHeatCapacityTri6(HeatCase):
    name, params, X, free = "heat_capacity_tri6", (2.5,), curved(TRI3), False


class TestLumpedHeatCapacityTri3(HeatCase):
    name, params, X, free = "lumped_heat_capacity_tri3", (2.5,), TRI3, False


class TestLumpedHeatCapacityTri6(HeatCase):
    name, params, X, free = "lumped_heat_capacity_tri6", (2.5,), curved(TRI3), False


class TestSurfaceHeatEdge2(HeatCase):
    name, params, X, free = "surface_heat_edge2", (0.6, -0.3, 0.8, 1.1, 0.2), SIDE, False


class TestSurfaceHeatEdge3(HeatCase):
    name, params, X, free = "surface_heat_edge3", (0.6, -0.3, 0.8, 1.1, 0.2), curved(SIDE), False

    @pytest.mark.parametrize("temperature", [0.0, 2.0])
    def test_what_leaves_is_film_times_temperature_less_flux(self, element, temperature):
        X = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]])
        leaving = self.residual(element, X, np.full((3, 1), temperature)).sum()
        assert leaving == pytest.approx((0.95 * temperature - 0.15) * 2.0 * 0.2)
