"""Derivatives by the thickness at each place: Taylor remainders against full solves, homogeneity, slender bars."""

import numpy as np
import pytest
from modal import SCENES, solved

from restshape.analysis.frame import Frame
from restshape.errors import ReplayProblem, UserError
from restshape.interface.first_frame import first_frame
from restshape.sensitivity.frequency_derivative import frequency_derivatives
from restshape.sensitivity.parameter_derivative import parameter_derivatives
from restshape.sensitivity.thickness_density import thickness_density, thickness_gradient

NO_CELLS = np.empty(0, dtype=np.int32)
THICK = ("tet4", "tet10", "plate")


def rasped(analysis, depth):
    """Frequencies with depths at the plane nodes taken off, of a full solve on the same mesh."""
    analysis.state.body.take_off(depth)
    analysis.state.space.mesh.geometry += 1
    analysis.solve(Frame(analysis.space, NO_CELLS, None, analysis.state.scene, (None, (0.0, 0.0))))
    return analysis.frequencies.copy()


def uneven(X):
    """Smooth depths of a share of 1 that nothing about the bars is symmetric to."""
    x, y = ((X - X.min(axis=0)) / np.ptp(X, axis=0)).T
    return 0.5 + 0.3 * np.sin(4.0 * x + y) + 0.2 * x * y


@pytest.mark.parametrize("model", THICK)
def test_remainder_is_of_second_order(model):
    analysis = solved(model)
    thickness = np.ptp(analysis.state.body.space.X[:, 2]) or analysis.state.body.space.X[0, 2]
    depth, f0 = uneven(analysis.space.X) * thickness, analysis.frequencies.copy()
    rates = -frequency_derivatives(analysis, analysis.state.body.thickness_motion(depth))
    remainders = [np.abs(rasped(analysis, h * depth) - f0 - h * rates) for h in (4e-3, 2e-3)]
    assert np.all(remainders[0] > 1e-8 * f0), "nothing to compare with"
    assert np.log2(remainders[0] / remainders[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("model", THICK)
def test_gradient_by_places_is_the_derivative_along_any_change(model):
    analysis = solved(model)
    corners = analysis.space.mesh
    change = uneven(corners.X)
    plane = analysis.space.X if analysis.space is not corners else corners.X
    # Linear between corners, so that nodes of second order have it too.
    everywhere = np.empty(len(plane))
    if analysis.space is corners:
        everywhere[:] = change
    else:
        everywhere[analysis.space.corner_number] = change
        everywhere[analysis.space.side_number] = change[corners.edge_nodes].mean(axis=1)
    along = frequency_derivatives(analysis, analysis.state.body.thickness_motion(everywhere))
    for rank, mode in enumerate(analysis.state.modes.chosen):
        found = thickness_density(analysis, int(mode))
        assert found.density * found.area @ change == pytest.approx(along[rank], rel=1e-9)


@pytest.mark.parametrize("model", THICK)
def test_all_places_together_are_the_thickness(model):
    analysis = solved(model)
    by_number = parameter_derivatives(analysis, "material.aluminium.thickness")
    found = [thickness_gradient(analysis, int(mode)).sum() for mode in analysis.state.modes.chosen]
    assert found == pytest.approx(by_number, rel=1e-6)


def test_slender_bar_has_the_densities_of_euler_and_bernoulli():
    """f grows by 3/2 of the share of bending energy and falls by 1/2 of that of the kinetic one, place by place."""
    thin = ["material.aluminium.thickness=0.0005", "material.aluminium.nu=0", "effects.modal.modes=1"]
    settings = [*thin, 'mesh.size="4 mm"', "effects.modal.model=plate", "solve.tolerance=1e-9"]
    analysis = first_frame(SCENES / "bar_100.toml", settings).analysis
    found, X = thickness_density(analysis, 0), analysis.space.X
    length, b = np.ptp(X[:, 0]), 4.730040744862704
    u = b * (X[:, 0] - X[:, 0].min()) / length
    ratio = (np.cosh(b) - np.cos(b)) / (np.sinh(b) - np.sin(b))
    deflection = np.cosh(u) + np.cos(u) - ratio * (np.sinh(u) + np.sin(u))
    curvature = np.cosh(u) - np.cos(u) - ratio * (np.sinh(u) - np.sin(u))
    bending, kinetic = (part**2 / (found.area @ part**2) for part in (curvature, deflection))
    expected = analysis.frequencies[0] / 0.0005 * (1.5 * bending - 0.5 * kinetic)
    # A node has the mean of its triangles, which do not lie evenly around it: means over tenths of the length.
    place = np.minimum((10.0 * u / b).astype(int), 9)
    ours, theirs = (np.bincount(place, found.area * each) for each in (found.density, expected))
    assert ours == pytest.approx(theirs, abs=0.01 * np.abs(theirs).max())


def test_nothing_is_rasped_through_and_plane_solids_have_no_underside():
    plate = solved("plate")
    with pytest.raises(ReplayProblem, match="thickness is"):
        plate.state.body.take_off(np.full(len(plate.space.X), 0.1))
    assert not plate.state.body.space.taken_off.any()
    with pytest.raises(UserError, match="underneath"):
        thickness_gradient(solved("plane"), 0)
