"""Two heavy folds, one inside the other, as two elastica that touch along a part of their way without friction."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

NEAR = (0.2, 4.15, 2.29, -0.21, 3.46, 3.05, 2.07, 0.48)
"""Of tips 0.56 apart, layers 0.01 apart: forces to the right and upwards where the inner fold leaves what it lies on,
and its length up to where the outer one begins to lie on it; the same of the outer one; the length that they lie on
each other; how far the outer one leaves the plane beyond the inner one."""
PLACES = 400
"""Places along an arc among which its highest, and its farthest one, are looked for."""
EXACT = 1e-8


def nested_heights(gap: float, apart: float) -> tuple[float, float]:
    """Heights of the inner and of the outer fold over the plane, over (D/w)^(1/3).

    The outer one comes from the plane, and the inner one from a layer on it. Each is a heavy elastica as in
    `loop_height` up to where the outer one lies down on the inner one. From there they have the same curvature, without
    friction, so that they are one strip of 2 D and 2 w, up to where they lie on the two layers below: forces, angle and
    curvature are continuous, for what they press each other with is not seen from outside. To first order in the gap.

    Args:
        gap: of layers.
        apart: how far the tip of the outer fold is beyond that of the inner one. All lengths over (D/w)^(1/3).

    Raises:
        ValueError: no such folds were found.
    """

    def misfit(values: np.ndarray) -> list[float]:
        inner, outer, both = _arcs(values, gap)
        (angle, bent, x, z), (other, curved, beyond, above) = inner[:, -1], outer[:, -1]
        place = [beyond + values[7] - x - gap * np.sin(angle), above - z - gap + gap * np.cos(angle)]
        landed = [both[0, -1] - np.pi, both[1, -1], both[3, -1] - 2.0 * gap]
        tips = outer[2].max() + values[7] - inner[2].max() - apart
        return [angle - other, bent - curved, *place, *landed, tips]

    found = fsolve(misfit, NEAR, full_output=True, xtol=1e-10)
    if np.abs(found[1]["fvec"]).max() > EXACT:
        raise ValueError(f"no folds with tips {apart:g} apart: {found[3]}")
    inner, outer, _ = _arcs(found[0], gap)
    return float(inner[3].max() + gap), float(outer[3].max())


def _arcs(values: np.ndarray, gap: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles, curvatures and places (4, n) along both folds alone, and along both that lie on each other.

    Args:
        values: as `NEAR`.
        gap: of layers.
    """
    right, up, length, other_right, other_up, other_length, touching, _ = values
    inner = _arc(right, up, length, 1.0, np.zeros(4))
    outer = _arc(other_right, other_up, other_length, 1.0, np.zeros(4))
    begin = inner[:, -1] + [0.0, 0.0, 0.0, gap]
    force = (right + other_right, up - length + other_up - other_length)
    return inner, outer, _arc(*force, touching, 2.0, begin)


def _arc(right: float, up: float, length: float, layers: float, begin: np.ndarray) -> np.ndarray:
    """Angle, curvature and place (4, n) along so many layers, from the first ones (4,), where these forces are."""

    def rates(s: float, y: np.ndarray) -> list[float]:
        turned = (right * np.sin(y[0]) + (up - layers * s) * np.cos(y[0])) / layers
        return [y[1], turned, np.cos(y[0]), np.sin(y[0])]

    places = np.linspace(0.0, length, PLACES)
    return solve_ivp(rates, (0.0, length), begin, rtol=1e-10, atol=1e-12, t_eval=places).y
