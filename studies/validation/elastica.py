"""The elastica: a slender strip that a dead force at its tip bends far, from its ordinary differential equation."""

import numpy as np
from scipy.integrate import solve_bvp


def stretched_elastica(load, height=0.01):
    """How far the tip of a strip of length 1 under P = load E I goes down and back: bent, and stretched along itself.

    The law along a fibre is P / E = l (l^2 - 1) / 2, as in the plane; M = E I theta' (3 l^2 - 1) / 2 to first order in
    the thickness. Shear is left out, which is small but at the wall.
    """
    bending = height**2 / 12
    stretches = np.linspace(0.6, 1.4, 4001)

    def stretch(angle):
        # The part of P along the strip, which hangs by the angle.
        return np.interp(load * bending * np.sin(angle), stretches * (stretches**2 - 1) / 2, stretches)

    def slopes(s, y):
        angle, moment, _, _ = y
        along = stretch(angle)
        return np.array(
            [
                moment / ((3 * along**2 - 1) / 2),
                -load * along * np.cos(angle),
                along * np.sin(angle),
                along * np.cos(angle),
            ]
        )

    # Fine at the wall, where it bends within 1 / sqrt(load).
    s = np.concatenate([[0.0], np.geomspace(1e-4, 1, 400)])
    angle = np.minimum(np.pi / 2, s * np.sqrt(load)) * 0.95
    start = np.array([angle, np.sqrt(load) * np.exp(-s * np.sqrt(load)), s * np.sin(angle), s * np.cos(angle)])
    found = solve_bvp(slopes, lambda a, b: np.array([a[0], b[1], a[2], a[3]]), s, start, tol=1e-6, max_nodes=100_000)
    assert found.success, found.message
    return found.y[2, -1], 1 - found.y[3, -1]
