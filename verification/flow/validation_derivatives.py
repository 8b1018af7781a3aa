"""Validation cases of derivatives by the design: of forces of a steady flow, of heat that it carries."""

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import IDENTITY, Check
from restshape_verification.flow import heated_scenes
from restshape_verification.flow.scenes import STEADY, channel, disc
from restshape_verification.flow.shown import shown

from restshape.analysis.frame import Frame
from restshape.sensitivity.steady_derivative import design_derivative

TAYLOR = "Taylor's theorem: what a derivative of first order leaves falls with the square of the way"
DIFFERENCE = 1e-5
"""Part of the whole way by which a quantity is differentiated where its unknowns are known."""
WAYS = (0.05, 0.025)
"""Parts of the whole way, which is some hundredths of the shape."""
TIGHT = 1e-12


def force_derivatives(comm: PETSc.Comm) -> list[Check]:
    """What the derivatives of drag and lift leave when the nodes around a body move."""
    asked = '[quantities]\ndrag = { drag = true, at = "body" }\nlift = { lift = true, at = "body" }\n'
    text = channel(3, 1, "rho = 1.5\nmu = 0.1\n", holes=disc("body", (1.0, 0.45), 0.15)) + STEADY + asked
    return _orders(text, ("drag", "lift"), comm)


def heat_derivatives(comm: PETSc.Comm) -> list[Check]:
    """What the derivatives of Nusselt number and mean temperature leave when the nodes of a vessel with a pipe move."""
    text = heated_scenes.CAVITY.replace("Ra = 1e4", "Ra = 3e3")
    text = text.replace("[fluid]", disc("pipe", (0.45, 0.55), 0.1) + "[fluid]")
    for temperature in ("300.5", "299.5", "300"):
        # Near zero, so that what changes is not the last digits of a mean.
        text = text.replace(f'"{temperature} K"', f'"{float(temperature) - 299:g} K"')
    text += heated_scenes.STEADY + heated_scenes.BUOYANT
    return _orders(text, ("hot", "mean"), comm)


def _orders(text: str, names: Sequence[str], comm: PETSc.Comm) -> list[Check]:
    """The orders of what is left of quantities by their derivatives along a motion of all nodes."""
    analysis = shown(f"{text}[solve]\ntolerance = {TIGHT!r}\n[mesh]\nsize = 0.12\n", comm).analysis
    space, state, x = analysis.space, analysis.state, analysis.x.copy()
    X = space.X.copy()
    low, high = X.min(axis=0), X.max(axis=0)
    (s, t), span = ((X - low) / (high - low)).T, 0.02 * (high - low)
    bump = np.sin(np.pi * s) * np.sin(np.pi * t)
    motion = span * np.stack([bump * (1 + s), bump * (1 + t) + 0.5 * np.sin(np.pi * s)], axis=1)
    dx = design_derivative(analysis, np.stack([motion, motion]), TIGHT)[0]

    def values(way: float, unknowns: np.ndarray) -> np.ndarray:
        """The quantities where nodes have gone a part of the way."""
        space.X[:] = X + way * motion
        space.geometry += 1
        analysis.problem.update()
        return np.array([state.observer.functions[name](unknowns) for name in names])

    def solved(way: float) -> np.ndarray:
        """Likewise, of the flow that is found there."""
        space.X[:] = X + way * motion
        space.geometry += 1
        analysis.solve(Frame(space, np.empty(0, np.int32), None, state.scene, (None, (0.0, 0.0))))
        return np.array([analysis.observe()[name] for name in names])

    first = values(0.0, x)
    slopes = values(DIFFERENCE, x + DIFFERENCE * dx) - values(-DIFFERENCE, x - DIFFERENCE * dx)
    rests = [np.abs(solved(way) - first - way * slopes / (2.0 * DIFFERENCE)) for way in WAYS]
    orders = np.log2(rests[0] / rests[1])
    return [
        Check(f"order of what is left of {name}", float(order), 2.0, 0.05, TAYLOR, IDENTITY)
        for name, order in zip(names, orders)
    ]
