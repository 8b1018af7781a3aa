"""Similar cloth comes to similar equilibria, whatever its size."""

import numpy as np
import pytest
from cloths import BALL, CONTACT, write_cloth

from restshape.interface.first_frame import first_frame

CLAMP = '[supports.clamp]\non = "left"\nfix = ["x", "y", "z", "slope"]\n'
SCALES = [2.0**-13, 2.0**-10, 2.0**10]
"""Powers of 2, so that rounding is the same and so are the meshes; the first is the square of no such power."""


def scaled(s: float, *more: str) -> list[str]:
    """Overrides that make the square of cotton s times as large, and the same in weight over both stiffnesses."""
    corners = [f"shape.vertices.{name}=[{x * s!r}, {y * s!r}]" for name, x, y in CORNERS]
    inner = ", ".join(f"[{x * s!r}, {y * s!r}]" for x, y in INNER)
    values = {"E": 2e6 * s, "thickness": 5e-4 * s, "bending": 0.1 * s**4}
    fabric = [f"material.cotton.{key}={value!r}" for key, value in values.items()]
    return [*corners, f"shape.regions.patch.polygon=[{inner}]", *fabric, f"mesh.size={0.25 * s!r}", *more]


CORNERS = [("a", 0.0, 0.0), ("b", 1.0, 0.0), ("c", 1.0, 1.0), ("d", 0.0, 1.0)]
INNER = [(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)]


def rest(path, s, *more):
    """Positions over s, energy over s^4, and the report of the first frame."""
    found = first_frame(path, scaled(s, *more)).analysis
    x = found.problem.corners(found.x)
    return x / s, found.problem.energy(found.x) / s**4, found.state.report


@pytest.fixture
def upright(tmp_path):
    """A sheet that stands upright on its clamp, too heavy to stay there."""
    text = write_cloth(tmp_path, CLAMP).read_text()
    path = tmp_path / "upright.toml"
    path.write_text(text.replace("[effects.gravity]\n", "[effects.gravity]\ng = [-9.81, 0, 0]\n"))
    return path


@pytest.mark.parametrize("s", SCALES)
def test_a_saddle_is_left_at_any_size(upright, s):
    """A step of fixed length stays on the saddle of large cloth, and crumples that of small cloth."""
    known, energy, report = rest(upright, 1.0)
    assert report.converged and report.stable and np.abs(known[:, 2]).max() > 0.1
    x, same, scaled_report = rest(upright, s)
    assert scaled_report.converged and scaled_report.stable
    assert same == pytest.approx(energy, rel=1e-9)
    # It may lean to either side. Both end at some residual below 1e-4 of the weight.
    assert min(np.abs(x - known).max(), np.abs(x * [1, 1, -1] - known).max()) < 5e-5
    if s != SCALES[0]:
        assert scaled_report.steps == report.steps


@pytest.mark.parametrize("s", SCALES[1:])
def test_cloth_on_a_ball_takes_the_same_way(tmp_path, s):
    path = write_cloth(tmp_path, BALL, CONTACT)

    def bodies(s):
        center = f"{0.5 * s!r}, {0.5 * s!r}, {-0.3 * s!r}"
        ball = f"bodies.ball={{sphere={{center=[{center}], radius={0.25 * s!r}}}, friction=0.3}}"
        return ball, f"effects.contact.thickness={2e-3 * s!r}", f"effects.contact.slip={1e-4 * s!r}"

    known, energy, report = rest(path, 1.0, *bodies(1.0))
    x, same, scaled_report = rest(path, s, *bodies(s))
    assert report.converged and scaled_report.steps == report.steps
    assert same == pytest.approx(energy, rel=1e-9) and np.abs(x - known).max() < 1e-9


@pytest.mark.parametrize("s", SCALES[1:])
def test_cloth_without_weight(tmp_path, s):
    """A sheet whose clamped end is turned up, which nothing but its stiffness brings to rest."""
    path = write_cloth(tmp_path, '[supports.end]\non = "right"\nfix = ["y"]\n', CLAMP)
    path.write_text(path.read_text().replace("[effects.gravity]\n", ""))

    def pushed(s):
        return (f"supports.push={{on='b', fix={{x={-0.1 * s!r}, z={0.05 * s!r}}}}}",)

    known, energy, report = rest(path, 1.0, *pushed(1.0))
    x, same, scaled_report = rest(path, s, *pushed(s))
    assert report.converged and np.abs(known[:, 2]).max() > 0.05
    assert scaled_report.steps == report.steps
    assert same == pytest.approx(energy, rel=1e-9) and np.abs(x - known).max() < 1e-9
