"""Elements of seams: springs, and what bends across edges that are sewn flat."""

import numpy as np
import pytest
from element_case import TRI3, taylor_slope
from test_flow_elements import FlowCase


class SeamCase(FlowCase):
    """The checks of an element with coefficients, which here have an energy too."""

    params = (1.7,)

    def test_residual_is_the_gradient_of_the_energy(self, element):
        x, v, w = self.sample(element, 1), self.direction((len(self.X), element.fields), 2), self.coefficients(element)
        slope = taylor_slope(
            lambda h: element.energy(self.X, x + h * v, self.cells, self.p, coefficients=w)[0],
            float(np.sum(self.residual(element, self.X, x) * v)),
        )
        assert slope > 1.9

    def test_tangent_is_symmetric(self, element):
        tangent = self.tangent(element, self.sample(element, 5))
        assert element.symmetric
        np.testing.assert_allclose(tangent, tangent.T, rtol=0, atol=1e-14 * np.abs(tangent).max())


class TestSeamEdge(SeamCase):
    name, X, params = "seam_edge3", TRI3, (1.7, 0.0)

    def coefficients(self, element):
        """Shares 0.4 between 0.1 and 0.7: the place is the middle of the edge; the spring stands for 0.3 m."""
        return np.array([[0.4, 0.3], [0.1, 0.0], [0.7, 0.0]])

    def test_its_energy_is_that_of_a_spring_to_the_middle_of_the_edge(self, element):
        x = self.sample(element, 3)
        gap = x[0] - 0.5 * (x[1] + x[2])
        energy = element.energy(self.X, x, self.cells, self.p, coefficients=self.coefficients(element))[0]
        assert energy == pytest.approx(0.5 * 1.7 * 0.3 * gap @ gap, rel=1e-12)


class TestSlackSeamEdge(TestSeamEdge):
    """Half as slack as the sample's gap is wide."""

    params = (1.7, 0.2)

    def test_its_energy_is_that_of_a_spring_to_the_middle_of_the_edge(self, element):
        x = self.sample(element, 3)
        gap = np.linalg.norm(x[0] - 0.5 * (x[1] + x[2]))
        assert gap > 0.3
        energy = element.energy(self.X, x, self.cells, self.p, coefficients=self.coefficients(element))[0]
        assert energy == pytest.approx(0.5 * 1.7 * 0.3 * (gap - 0.2) ** 2, rel=1e-12)

    def test_within_its_slack_it_does_not_pull(self, element):
        x = np.array([[0.5, 0.1, 0.05], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
        assert not self.residual(element, self.X, x).any() and not self.tangent(element, x).any()


class TestSeamFlat(SeamCase):
    name, X = "seam_flat_flap6", np.vstack([TRI3, TRI3 @ [[0.0, 1.1], [-0.9, 0.0]] + [2.0, 0.3]])

    def coefficients(self, element):
        return np.array([[0.3]] + [[0.0]] * 5)

    def test_a_plane_bends_by_nothing(self, element):
        """Two triangles in one plane, sewn along their edges, have opposite slopes."""
        X = np.vstack([TRI3, TRI3[1], TRI3[0], TRI3[0] + TRI3[1] - TRI3[2]])
        x = np.column_stack([X, X @ [0.3, -0.2]])
        np.testing.assert_allclose(self.residual(element, X, x), 0.0, atol=1e-13)


class TestSeamSlope(SeamCase):
    name, X = "seam_slope_point2", TRI3[:2].copy()

    def coefficients(self, element):
        return np.array([[0.8, 0.3], [-1.1, 0.0]])

    def test_slopes_that_cancel_have_no_moment(self, element):
        x = np.array([[1.1, 2.2, -3.3], [0.8, 1.6, -2.4]])
        np.testing.assert_allclose(self.residual(element, self.X, x), 0.0, atol=1e-13)
