"""The answer of a frame, as who compares answers of different settings sees it, whatever the analysis."""

import dataclasses
from dataclasses import dataclass

import numpy as np

from restshape.fem.problem import SteadyProblem


def _none() -> np.ndarray:
    return np.empty(0)


@dataclass(frozen=True)
class Solution:
    """What an analysis has found; copies, which stay when it goes on.

    Args:
        name: of `field`, such as "displacement".
        field: (n, f) of the nodes of `Analysis.space`; None where there are modes only.
        rate: (n, f) its rate in time, of what has inertia; else None.
        spectrum: what `values` are, "frequencies" or "load_factors"; empty where there are none.
        values: (k,) ascending; ids: (k,) numbers that their modes keep from frame to frame.
        shapes: (modes, n, d) fields of the modes.
        moduli: (ne, 3) as of `SteadyProblem.energy_moduli`; None where the energy is not of that form.
        mass: (ne,) [kg/m^2] of the cells, of what has inertia; else None.
        large: strains are Green's; averaged: elements take the means of their dilatation.
        curvature: (ne, 3, 3) second derivatives xx, yy and twice xy of each coordinate of a sheet [1/m], else None.
        sheet: (ne, 2, 3, 3) its stiffness against strains [N/m] and curvatures [N m], else None.
    """

    name: str = ""
    field: np.ndarray | None = None
    rate: np.ndarray | None = None
    spectrum: str = ""
    values: np.ndarray = dataclasses.field(default_factory=_none)
    ids: np.ndarray = dataclasses.field(default_factory=_none)
    shapes: np.ndarray = dataclasses.field(default_factory=_none)
    moduli: np.ndarray | None = None
    mass: np.ndarray | None = None
    large: bool = False
    curvature: np.ndarray | None = None
    sheet: np.ndarray | None = None
    averaged: bool = False


def moduli_of(problem: SteadyProblem) -> np.ndarray | None:
    """`SteadyProblem.energy_moduli` as a row for each cell (ne, 3), copied."""
    moduli = problem.energy_moduli()
    return None if moduli is None else np.array(np.broadcast_to(moduli, (len(problem.space.cells), 3)))


def stacked_modes(points: dict[str, np.ndarray], prefix: str, count: int) -> np.ndarray:
    """Fields (modes, n, d) of those of `count` modes, named by a prefix and their number, that are among `points`."""
    names = [f"{prefix}{k}" for k in range(1, count + 1)]
    found = [points[name] for name in names if name in points]
    return np.stack(found) if found else np.empty((0, 0, 0))
