"""What a frame's solution is, whatever the analysis: values, and fields over the plane."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from restshape_studies.accuracy.grid import Grid, Places

from restshape.physics.cloth.relaxation.analysis import RelaxationAnalysis

SPECTRA = {"frequencies": "mode_", "load_factors": "buckling_mode_"}
"""Attribute of an analysis that has eigenvalues, and how the fields of their modes are named."""


@dataclass(frozen=True)
class State:
    """The solution of one frame.

    Args:
        grid: the plane mesh of the fields.
        outline: (k, 2) control points of the shape [m].
        displacement: (n, 2) [m], of cloth (n, 3); None where there are modes only.
        velocity: (n, 2) [m/s] of what moves, else None.
        spectrum: what `values` are, "frequencies" or "load_factors"; empty where there are none.
        values: (k,) ascending.
        shapes: (modes, n, d) fields of the modes.
        stiffness: (ne, 4) lambda [Pa], mu [Pa], thickness [m] and, of what moves, mass [kg/m^2] of each cell; None
            without a displacement, and of cloth.
        large: strains are Green's, for the deformation is large.
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

    @property
    def quantities(self) -> dict[str, float]:
        """Quantities of interest by name."""
        return {key[2:]: float(value) for key, value in self.row.items() if key.startswith("q_")}


def state_of(analysis: Any, outline: np.ndarray, row: dict[str, Any]) -> State:
    """The solution that an analysis has just found.

    Args:
        analysis: of any kind.
        outline: (k, 2) control points of the shape [m].
        row: of the frame, with the quantities as q_NAME.
    """
    if isinstance(analysis, RelaxationAnalysis):
        return _cloth(analysis, outline, row)
    spectrum = next((name for name in SPECTRA if hasattr(analysis, name)), "")
    values, shapes = np.empty(0), np.empty((0, len(analysis.space.X), 2))
    if spectrum:
        values = np.array(getattr(analysis, spectrum), dtype=float)
        points, _ = analysis.fields()
        names = [f"{SPECTRA[spectrum]}{k}" for k in range(1, len(values) + 1)]
        shapes = np.stack([points[name] for name in names if name in points]) if len(values) else shapes
    displacement = velocity = stiffness = solid = None
    if spectrum != "frequencies":
        body = getattr(analysis, "body", None)
        displacement, stiffness = analysis.x.copy(), np.zeros((len(analysis.space.cells), 4))
        solid = body.problem if body else analysis.problem
        stiffness[:, :3] = solid.stiffness_params[..., :3]
        if body:
            velocity = analysis.v.copy()
            stiffness[:, 3:] = body.mass.params
    grid = Grid.of(analysis.space)
    large = solid is not None and not solid.linear
    return State(grid, outline.copy(), displacement, velocity, spectrum, values, shapes, stiffness, large, dict(row))


def _cloth(analysis: Any, outline: np.ndarray, row: dict[str, Any]) -> State:
    """The positions, as displacements from the flat pattern, that cloth rests at."""
    grid, displacement = Grid.of(analysis.space), analysis.fields()[0]["displacement"]
    shape, fabric = (len(grid.cells), 3, 3), analysis.problem.fabric
    stiffness = np.stack([np.broadcast_to(part, shape) for part in (fabric.membrane, fabric.bending)], axis=1)
    curvature, none = analysis.error_estimate.curvatures(analysis.x), np.empty((0, len(grid.X), 3))
    state = State(grid, outline.copy(), displacement, None, "", np.empty(0), none, None, True, dict(row))
    return replace(state, curvature=curvature, sheet=stiffness)


def strains(gradient: np.ndarray, large: bool) -> np.ndarray:
    """Strains (m, 2, 2), small ones or Green's, of displacement gradients (m, 2, 2), or (m, 3, 2) of surfaces."""
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
            u, strain = places.field(state.displacement), strains(places.gradient(state.displacement), state.large)
        shapes = np.stack([places.field(shape) for shape in state.shapes]) if len(state.shapes) else state.shapes[:, :0]
        curvature = None if state.curvature is None else state.curvature[places.cells]
        return cls(u, strain, v, state.values, shapes, state.quantities, curvature)
