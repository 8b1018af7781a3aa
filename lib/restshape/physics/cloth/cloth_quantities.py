"""Quantities of interest of cloth: numbers that a scene asks for, taken from its positions."""

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from restshape.errors import UserError
from restshape.fem.entity_sets import observed_nodes
from restshape.fem.observer import Observer, area_at, reduction
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.drape_shadow import DrapeShadow
from restshape.physics.cloth.sheet.cloth_boundary import ClothDirichlet
from restshape.scene.model import Quantity

AXES = "xyz"


class ObservedCloth(Protocol):
    """What quantities need of cloth.

    Attributes:
        mesh: of its corners; boundary: what supports hold of its nodes.
    """

    mesh: Mesh
    boundary: ClothDirichlet

    def corners(self, x: np.ndarray) -> np.ndarray:
        """Positions (corners, 3) [m] of the mesh's nodes."""

    def unconstrained_residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the residual at x (n, 3) without supports."""

    def energy(self, x: np.ndarray) -> float:
        """Potential energy [J] at x (n, 3), of weight too."""

    def membrane_energy(self, x: np.ndarray) -> float:
        """Energy [J] of stretching at x (n, 3)."""

    def bending_energy(self, x: np.ndarray) -> float:
        """Energy [J] of bending at x (n, 3)."""

    def seam_energy(self, x: np.ndarray) -> float:
        """Energy [J] of seams at x (n, 3)."""


def observer(problem: ObservedCloth, quantities: Mapping[str, Quantity]) -> Observer:
    """What evaluates the quantities of a scene at positions x (n, 3) [m] of its cloth.

    Displacements are counted from where the cloth was cut, as the mesh lies now.

    Raises:
        UserError: a quantity has no meaning for cloth, or names a place that is not there.
    """
    return Observer({name: _function(problem, name, quantity) for name, quantity in quantities.items()})


def of_places(quantities: Mapping[str, Quantity]) -> bool:
    """Whether quantities are of where the cloth lies alone, and not of what it resists with."""
    return not any(quantity.reaction or quantity.energy for quantity in quantities.values())


def reactions(problem: ObservedCloth, x: np.ndarray) -> np.ndarray:
    """Forces (corners, 3) [N] of supports on the nodes at x (n, 3); 0 along what none of them holds."""
    out = np.empty_like(x)
    problem.unconstrained_residual(x, out)
    return problem.corners(np.where(problem.boundary.mask, out, 0.0))


def _function(problem: ObservedCloth, name: str, quantity: Quantity) -> Callable[[np.ndarray], float]:
    mesh = problem.mesh
    if quantity.area:
        return area_at(mesh, name, quantity)
    if quantity.energy:
        return _energy(problem, quantity.energy)
    if quantity.drape_coefficient:
        return _drape_coefficient(problem, name, quantity)
    if quantity.folds:
        shadow = DrapeShadow.of(mesh)
        return lambda x: float(shadow.folds(problem.corners(x)))
    if not (quantity.displacement or quantity.position or quantity.reaction):
        raise UserError(
            f"cloth has no quantity of the kind {quantity.kind!r}",
            f"quantities.{name}",
            "use displacement, position, reaction, energy, area, drape_coefficient or folds",
        )
    nodes = observed_nodes(mesh, name, quantity)
    if quantity.reaction:
        column = AXES.index(quantity.reaction)
        return lambda x: reactions(problem, x)[nodes, column].sum()
    if quantity.position:
        return _position(problem, quantity, nodes)
    return _displacement(problem, quantity, nodes)


def _drape_coefficient(problem: ObservedCloth, name: str, quantity: Quantity) -> Callable[[np.ndarray], float]:
    """Area of the shadow over that of the flat cloth, both less that of the disc that a region lies on.

    Raises:
        UserError: there is no such region, or it is all of the cloth.
    """
    mesh = problem.mesh
    shadow, flat = DrapeShadow.of(mesh), mesh.outline.area()
    disc = area_at(mesh, name, quantity)() if quantity.at is not None else 0.0
    if disc >= flat:
        raise UserError("all of the cloth lies on the disc", f"quantities.{name}.at", "name a region, a part of it")
    return lambda x: (shadow.area(problem.corners(x)) - disc) / (flat - disc)


def _position(problem: ObservedCloth, quantity: Quantity, nodes: np.ndarray | slice) -> Callable[[np.ndarray], float]:
    reduce, column = reduction(problem.mesh, quantity, nodes), AXES.index(quantity.position)
    return lambda x: reduce(problem.corners(x)[nodes, column])


def _displacement(
    problem: ObservedCloth, quantity: Quantity, nodes: np.ndarray | slice
) -> Callable[[np.ndarray], float]:
    reduce = reduction(problem.mesh, quantity, nodes)
    flat = np.column_stack([problem.mesh.X, np.zeros(len(problem.mesh.X))])

    def moved(x: np.ndarray) -> np.ndarray:
        return (problem.corners(x) - flat)[nodes]

    if quantity.displacement == "magnitude":
        return lambda x: reduce(np.linalg.norm(moved(x), axis=1))
    column = AXES.index(quantity.displacement)
    return lambda x: reduce(moved(x)[:, column])


def _energy(problem: ObservedCloth, kind: str) -> Callable[[np.ndarray], float]:
    kinds = {
        "strain": lambda x: problem.membrane_energy(x) + problem.bending_energy(x),
        "membrane": problem.membrane_energy,
        "bending": problem.bending_energy,
        "seams": problem.seam_energy,
        "potential": problem.energy,
    }
    return kinds[kind]
