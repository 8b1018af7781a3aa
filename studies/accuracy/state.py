"""What a frame's solution is, whatever the analysis: values, and fields over the plane."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from restshape_studies.accuracy.grid import Grid, Places

from restshape.analysis.analysis import Analysis
from restshape.replay.columns import quantity_column, quantity_names

THREE_POINTS = np.array([[1.0, 1.0], [4.0, 1.0], [1.0, 4.0]]) / 6.0
"""Of a rule of degree 2 over a triangle: a dilatation of second order times the area is no more, on curves too."""


@dataclass(frozen=True)
class State:
    """The solution of one frame.

    Args:
        grid: the plane mesh of the fields.
        outline: (k, 2) control points of the shape [m].
        displacement: (n, 2) [m], of cloth (n, 3), or (n, 1) a temperature [K]; None where there are modes only.
        velocity: (n, 2) [m/s] of what moves, else None.
        spectrum: what `values` are, "frequencies" or "load_factors"; empty where there are none.
        values: (k,) ascending.
        shapes: (modes, n, d) fields of the modes.
        stiffness: (ne, 4) moduli of the energy, as of `SteadyProblem.energy_moduli`, and, of what moves, mass [kg/m^2]
            of each cell; None without a displacement, and of cloth.
        large: strains are Green's, for the deformation is large.
        averaged: cells have one dilatation each, the mean.
        row: of the frame.
        curvature: (ne, 3, 3) second derivatives xx, yy and twice xy of each coordinate of cloth [1/m].
        sheet: (ne, 2, 3, 3) its stiffness against strains [N/m] and curvatures [N m]. None of what is no cloth, both.
    """

    grid: Grid
    outline: np.ndarray
    displacement: np.ndarray | None
    velocity: np.ndarray | None
    spectrum: str
    values: np.ndarray
    shapes: np.ndarray
    stiffness: np.ndarray | None
    large: bool
    row: dict[str, Any]
    curvature: np.ndarray | None = None
    sheet: np.ndarray | None = None
    averaged: bool = False

    @property
    def quantities(self) -> dict[str, float]:
        """Quantities of interest by name."""
        return {name: float(self.row[quantity_column(name)]) for name in quantity_names(self.row)}


def state_of(analysis: Analysis, outline: np.ndarray, row: dict[str, Any]) -> State:
    """The solution that an analysis has just found.

    Args:
        analysis: of any kind.
        outline: (k, 2) control points of the shape [m].
        row: of the frame, with the quantities as q_NAME.
    """
    found, stiffness, grid = analysis.solution(), None, Grid.of(analysis.space)
    if found.moduli is not None:
        mass = np.zeros(len(found.moduli)) if found.mass is None else found.mass
        stiffness = np.column_stack([found.moduli, mass])
    shapes = found.shapes if len(found.shapes) else np.empty((0, len(grid.X), 2))
    state = State(
        grid,
        outline.copy(),
        found.field,
        found.rate,
        found.spectrum,
        found.values,
        shapes,
        stiffness,
        found.large,
        dict(row),
    )
    return replace(state, curvature=found.curvature, sheet=found.sheet, averaged=found.averaged)


def strains_of(state: State, places: Places) -> np.ndarray:
    """Strains (m, 2, 2) of its displacement at places of its grid, with the dilatation that its elements take there."""
    strain = strains(places.gradient(state.displacement), state.large)
    if not state.averaged:
        return strain
    parts, cells = np.zeros((2, len(state.grid.cells))), np.arange(len(state.grid.cells))
    for point in THREE_POINTS:
        inside = Places(state.grid, cells, np.tile(point, (len(cells), 1)))
        own = strains(inside.gradient(state.displacement), state.large)
        parts += inside.area * np.trace(own, axis1=1, axis2=2), inside.area
    lacking = (parts[0] / parts[1])[places.cells] - np.trace(strain, axis1=1, axis2=2)
    return strain + 0.5 * lacking[:, None, None] * np.eye(2)


def strains(gradient: np.ndarray, large: bool) -> np.ndarray:
    """Strains (m, 2, 2), small ones or Green's, of displacement gradients (m, 2, 2), or (m, 3, 2) of surfaces.

    Of the gradient (m, 1, 2) of a scalar it is the first row.
    """
    if gradient.shape[1] == 1:
        return np.concatenate([gradient, np.zeros_like(gradient)], axis=1)
    plane = gradient[:, :2]
    strain = 0.5 * (plane + plane.transpose(0, 2, 1))
    # Turns alone are no strain, however far.
    return strain + 0.5 * np.einsum("mki,mkj->mij", gradient, gradient) if large else strain


@dataclass(frozen=True)
class Sampled:
    """A solution at the places that distances are measured at.

    Args:
        u: (m, 2) displacement [m], of cloth (m, 3); strain: (m, 2, 2); None without a displacement.
        v: (m, 2) velocity [m/s] of what moves, else None.
        values: (k,) frequencies or load factors.
        shapes: (modes, m, d).
        quantities: by name.
        curvature: (m, 3, 3) of cloth, as in `State`, else None.
    """

    u: np.ndarray | None
    strain: np.ndarray | None
    v: np.ndarray | None
    values: np.ndarray
    shapes: np.ndarray
    quantities: dict[str, float] = field(default_factory=dict)
    curvature: np.ndarray | None = None

    @classmethod
    def of(cls, state: State, places: Places) -> Sampled:
        """A solution at places of its own grid."""
        u = strain = v = None
        if state.velocity is not None:
            v = places.field(state.velocity)
        if state.displacement is not None:
            u, strain = places.field(state.displacement), strains_of(state, places)
        shapes = np.stack([places.field(shape) for shape in state.shapes]) if len(state.shapes) else state.shapes[:, :0]
        curvature = None if state.curvature is None else state.curvature[places.cells]
        return cls(u, strain, v, state.values, shapes, state.quantities, curvature)
