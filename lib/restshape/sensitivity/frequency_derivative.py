"""How frequencies and modes follow the shape: along a drag, by nodes, along the outline, with the material."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.algebra.eigenproblems.clusters import clusters
from restshape.algebra.eigenproblems.eigen import EigenSolver
from restshape.fem.assembled import Assembled
from restshape.fem.problem import MASS, STIFFNESS
from restshape.sensitivity.mode_change import change_beyond

if TYPE_CHECKING:
    from restshape.analysis.analysis import Context
    from restshape.analysis.modal.modal_state import ModalState
    from restshape.fem.eigenproblem import Maker

COINCIDE, ROUNDING = 100.0, 1e-9
"""Eigenvalues whose distance, as a share of themselves, is below that many squares of the tolerance of residuals, or
below rounding, coincide: the solve does not distinguish their modes."""


class SolvedModes(Protocol):
    """What a derivative needs of an analysis of free vibrations that has been solved on the mesh as it lies."""

    state: ModalState
    solver: EigenSolver
    context: Context
    make: Maker


def design_products(analysis: SolvedModes, modes: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """K' phi and M' phi (k, n f) of modes (k, n f) when the nodes of the body move with a velocity (n, d)."""
    body = analysis.state.body
    boundary, found = body.boundary, []
    for kind in (STIFFNESS, MASS):
        assembled, rows = Assembled(body.integrals(kind)), []
        for mode in modes:
            product = assembled.design_product(np.ascontiguousarray(mode.reshape(boundary.mask.shape)), velocity)
            boundary.zero(product)
            rows.append(product.ravel())
        found.append(np.stack(rows))
    return found[0], found[1]


def frequency_derivatives(analysis: SolvedModes, velocity: np.ndarray, width: float = 0.0) -> np.ndarray:
    """Derivatives (modes,) [Hz] of the frequencies that the scene asks for, where nodes move with a velocity (n, d).

    phi^T (K' - lambda M') phi; of eigenvalues that coincide the eigenvalues of Phi^T (K' - lambda M') Phi, ascending:
    they belong to modes that the direction chooses.

    Args:
        analysis: solved on the mesh as it lies.
        velocity: of the nodes of the body, such as `VibratingBody.motion` gives it from that of the plane mesh.
        width: share below which eigenvalues coincide, beyond those that the solve does not distinguish: with `CLUSTER`
            a pair that the mesh parts has the rates of one that it does not.

    Source: docs/theory/free-vibrations.md.
    """
    known = known_modes(analysis)
    vectors = analysis.state.modes.vectors[known]
    return rates(analysis, known, *design_products(analysis, vectors, velocity), width)


def rates(
    analysis: SolvedModes, known: np.ndarray, stiff: np.ndarray, mass_products: np.ndarray, width: float = 0.0
) -> np.ndarray:
    """Derivatives (modes,) of the frequencies that the scene asks for, from K' phi and M' phi of the known modes.

    Args:
        analysis: solved on the mesh as it lies.
        known: (k,) indices of modes that have converged, those of clusters together.
        stiff, mass_products: (k, n f) K' phi and M' phi; width: as in `frequency_derivatives`.
    """
    state = analysis.state
    modes, values = state.modes.vectors[known], state.modes.values[known]
    middle = 0.5 * (values[:, None] + values[None, :])
    found = parted(values, modes @ stiff.T - middle * (modes @ mass_products.T), analysis.solver.tolerance, width)
    return found[state.modes.chosen] / (8.0 * np.pi**2 * state.frequencies)


def parted(values: np.ndarray, rates: np.ndarray, tolerance: float, width: float = 0.0) -> np.ndarray:
    """Derivatives (k,) of eigenvalues (k,), ascending, from the rates (k, k) of the matrix that their modes see.

    Those on its diagonal, as long as the solve distinguishes the modes: residuals of a share eps leave modes whose
    eigenvalues differ by a share g turned by some eps^2/g into each other. Below g = `COINCIDE` eps^2 the eigenvalues
    of the block, which no turning changes, in ascending order: so they lie after a step ahead.

    Args:
        values, rates: of the known modes.
        tolerance: eps of the modes; width: g, where it is more.

    Source: docs/theory/free-vibrations.md.
    """
    found = np.empty(len(values))
    for group in clusters(values, max(COINCIDE * tolerance**2, ROUNDING, width)):
        block = rates[np.ix_(group, group)]
        found[group] = np.linalg.eigvalsh(0.5 * (block + block.T))
    return found


def known_modes(analysis: SolvedModes) -> np.ndarray:
    """Indices of the modes that have converged: at least those up to the last one that is asked for and its cluster."""
    return np.arange(min(analysis.state.count, len(analysis.state.modes.values)))


def stands_alone(analysis: SolvedModes, mode: int) -> bool:
    """Whether the eigenvalue of a mode, an index among the modes, is in no cluster with others."""
    return any(len(group) == 1 and group[0] == mode for group in clusters(analysis.state.modes.values))


# --- along a drag --------------------------------------------------------------------------------------------------


def modal_derivative(analysis: SolvedModes, plane_motion: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives (2, k, k + n f) of `ModalPrediction.values` along the two directions of the hand.

    All modes that are known are one cluster to the subspace rule: H' = Phi^T (K' - (lambda_i + lambda_j)/2 M') Phi, so
    that a prediction H + c H' knows of crossings between them. A mode changes by its turning among them, which is left
    to the eigenvectors of H, by -1/2 Phi^T M' Phi, which keeps them orthonormal, by rigid motions, and by all that is
    beyond: (K - lambda M) v = -(K' - lambda M') phi there, the bordered system less what is known of its solution.

    Args:
        analysis: solved on the mesh as it lies.
        plane_motion: (2, n2, 2) velocities of the nodes of the plane mesh a unit of each of the hand's coefficients.
        tolerance: of each solve, relative to its right side.

    Raises:
        ReplayProblem: a solve does not converge.

    Source: docs/theory/free-vibrations.md; (D.7), (D.9) of the thesis, mended.
    """
    known, state = known_modes(analysis), analysis.state
    count, n = state.modes.vectors.shape
    result = np.zeros((2, count, count + n))
    modes, values = state.modes.vectors[known], state.modes.values[known]
    weighted = state.modes.mass_products[: len(known)]
    for direction, velocity in zip(result, state.body.motion(plane_motion)):
        if not np.any(velocity):
            continue
        stiff, mass_products = design_products(analysis, modes, velocity)
        reduced_mass = modes @ mass_products.T
        middle = 0.5 * (values[:, None] + values[None, :])
        direction[: len(known), : len(known)] = modes @ stiff.T - middle * reduced_mass
        change = -0.5 * reduced_mass @ modes
        for k in known:
            force = -(stiff[k] - values[k] * mass_products[k])
            change[k] += change_beyond(analysis.solver, modes, weighted, float(values[k]), force, tolerance)
        direction[: len(known), count:] = change
    return result


# --- by nodes, along the outline -----------------------------------------------------------------------------------


def nodal_gradient(analysis: SolvedModes, mode: int, axes: np.ndarray | None = None) -> np.ndarray:
    """The gradient (n, d) of an eigenvalue by the places of the body's nodes: phi^T (K_X - lambda M_X) phi.

    Args:
        analysis: solved on the mesh as it lies.
        mode: index among the modes; its eigenvalue stands alone.
        axes: along which it is wanted, 0 along others; None: all.
    """
    body, modes = analysis.state.body, analysis.state.modes
    phi, value = modes.vectors[mode].reshape(body.boundary.mask.shape), modes.values[mode]
    (stiff,), (mass_products,) = (
        [integral.work_derivatives(phi, axes) for integral in body.integrals(kind)] for kind in (STIFFNESS, MASS)
    )
    rates, gradient = stiff - value * mass_products, np.zeros_like(body.space.X)
    for i, nodes in enumerate(body.space.cells.T):
        for axis in range(gradient.shape[1]):
            gradient[:, axis] += np.bincount(nodes, rates[:, i, axis], len(gradient))
    return gradient


def material_derivatives(analysis: SolvedModes, mode: int) -> dict[str, dict[str, float]]:
    """Derivatives of a frequency [Hz] by each material's `E` [Hz/Pa] and `rho` [Hz m^3/kg], its Poisson's ratios kept.

    K is proportional to E in the cells of a material, and M to rho. Of a material with a grain `stiffness` [Hz] is the
    derivative by a factor on all of its moduli, in place of E.

    Args:
        analysis: solved on the mesh as it lies.
        mode: index among the modes; its eigenvalue stands alone.
    """
    body, modes = analysis.state.body, analysis.state.modes
    value = float(modes.values[mode])
    phi = np.ascontiguousarray(modes.vectors[mode].reshape(body.boundary.mask.shape))
    (stiff,), (mass_products,) = (
        [2.0 * part.energies(phi) for part in body.integrals(kind)] for kind in (STIFFNESS, MASS)
    )
    scale = 1.0 / (8.0 * np.pi**2 * np.sqrt(value) / (2.0 * np.pi))
    result = {}
    for name, material in analysis.state.scene.material.items():
        regions = [k for k, own in enumerate(body.materials) if own is material]
        cells = np.isin(body.space.cell_region, regions)
        key, size = ("stiffness", 1.0) if material.E is None else ("E", material.E)
        result[name] = {
            key: scale * float(stiff[cells].sum()) / size,
            "rho": -scale * value * float(mass_products[cells].sum()) / material.rho,
        }
    return result
