"""Where cloth begins: as the scene places it, then out of bodies, and each layer outside of those below."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.errors import UserError
from restshape.fem.entity_sets import nodes_on
from restshape.mesh.relocate import HarmonicExtension
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.out_of_bodies import brought_out, still_inside, through_words
from restshape.physics.cloth.contact.squeezed import refuse_squeezed
from restshape.physics.cloth.contact.tunnelling import penetrations
from restshape.physics.cloth.retreat import retreats
from restshape.physics.cloth.scene import ClothArguments
from restshape.physics.cloth.seams.seam_order import order_notes
from restshape.physics.cloth.self_contact.layer_order import ROOM, WIDENINGS, WIDER, Layers
from restshape.physics.cloth.trust import penetration_notes
from restshape.scene.model import Scene

RETREATED = "it goes back at first, and comes to its place again: the nearest way out would fold the cloth over"


@dataclass(frozen=True, eq=False)
class Beginning:
    """Where cloth begins.

    Args:
        x: (n, 3) unknowns.
        placed: (corners, 3) [m] as the scene has it; out: out of bodies; ordered: with its layers in order.
        movable: (corners,) whether nothing holds a node.
        retreat: (k, 3) [m] how far each body is from its place at first, see `retreats`; None: all are there.
        doubts: what could not be done.
    """

    x: np.ndarray
    placed: np.ndarray
    out: np.ndarray
    ordered: np.ndarray
    movable: np.ndarray
    retreat: np.ndarray | None = None
    doubts: tuple[str, ...] = ()


def beginning(problem: ClothProblem, arguments: ClothArguments, retreating: bool = True) -> Beginning:
    """Where cloth begins, with supports where they are at first; bodies may be `retreating` from it."""
    x = _placed(problem, arguments)
    placed = out = problem.corners(x)
    movable, doubts = ~arguments.supports.mask.any(axis=1), []
    if contact := problem.contact:
        out = brought_out(contact.bodies, placed, problem.mesh.cells, movable, contact.thickness)
        if retreating and (retreat := retreats(problem, arguments.forms, placed, out)) is not None:
            return Beginning(x, placed, placed, placed, movable, retreat)
        if count := int((movable & still_inside(contact.bodies, out, contact.thickness)).sum()):
            doubts.append(f"{_nodes(count)} still inside bodies: no way out was found")
        doubts.append(through_words(contact.bodies, placed, out, problem.mesh.edge_nodes))
    ordered, doubt = _ordered(problem, out, movable)
    x = x if np.array_equal(ordered, placed) else problem.flat(ordered)
    return Beginning(x, placed, out, ordered, movable, doubts=tuple(filter(None, [*doubts, doubt])))


def _ordered(problem: ClothProblem, x: np.ndarray, movable: np.ndarray) -> tuple[np.ndarray, str]:
    """Places (n, 3) [m] of the corners with layers in order, at so large a distance that they do not cross.

    Where they cross at every distance they stay at x (n, 3) [m]. Returned too is what there is to say of that.
    """
    layers, contact = problem.ordered_layers, problem.self_contact
    if layers is None or contact is None:
        return x, ""
    gap = ROOM * contact.values.thickness
    for _ in range(WIDENINGS):
        found, ended = layers.in_order(x, movable, gap)
        if not problem.surface.crosses(found):
            return found, "" if ended else "layers are not all in order: their nodes were moved again and again"
        gap *= WIDER
    return x, "layers were not put in order: they would pass through each other"


def _placed(problem: ClothProblem, arguments: ClothArguments) -> np.ndarray:
    """Unknowns (n, 3) of the initial placement as the scene has it, with supports where they are at first.

    Supports that would go through the flat cloth on their way there draw it along, the less the farther it is.
    """
    x = problem.flat(arguments.start)
    ways = arguments.start - arguments.placed
    if not problem.self_contact or not ways.any() or problem.begin(x):
        return x
    constrained = np.flatnonzero(arguments.supports.mask.any(axis=1)).astype(np.int32)
    drawn = arguments.placed + HarmonicExtension(problem.mesh, constrained).adapted(ways[constrained])
    return problem.flat(np.where(arguments.supports.mask, arguments.start, drawn))


def start_notes(problem: ClothProblem, begun: Beginning, scene: Scene) -> list[str]:
    """What there is to note of bodies, of layers and of the order of seams, where a scene places its cloth.

    Raises:
        UserError: two bodies hold it between them, or a support holds a layer below one that it lies outside of.
    """
    orders = order_notes(scene, problem.mesh, begun.placed)
    found = []
    if problem.contact:
        refuse_squeezed(problem.contact, begun.placed, scene.bodies)
        found = penetration_notes("begins", problem, scene, penetrations(problem.contact, begun.placed))
        if begun.retreat is not None:
            return [*(f"{note}: {RETREATED}" for note in found), *orders]
        out = _moved(begun.placed, begun.out)
        found = [f"{note}: {out} put outside, the nearest way" if out else note for note in found]
    if problem.ordered_layers:
        _refuse_constrained(problem, problem.ordered_layers, begun, scene)
        if (ordered := _moved(begun.out, begun.ordered)) and not problem.ordered_layers.notes(begun.ordered):
            found.append(f"{ordered} put outside of lower layers")
    return [*found, *begun.doubts, *orders]


def _refuse_constrained(problem: ClothProblem, layers: Layers, begun: Beginning, scene: Scene) -> None:
    """Refuse supports that hold nodes of a layer below one that it should lie outside of."""
    node, cell = layers.below(begun.ordered)
    constrained = np.flatnonzero(~begun.movable[node])
    if not len(constrained):
        return
    node, cell = node[constrained[0]], cell[constrained[0]]
    holding = (f"supports.{name}" for name, one in scene.supports.items() if node in nodes_on(problem.mesh, one.on))
    upper, lower = (layers.order.names[layers.order.node_panel[one]] for one in (node, layers.cells[cell, 0]))
    raise UserError(
        f"it holds {upper} below {lower}, which is of a lower layer",
        next(holding, "hold.to"),
        f"move {upper} out, or change panels.{upper}.layer",
    )


def _moved(before: np.ndarray, after: np.ndarray) -> str:
    """How many nodes are elsewhere after than before (n, 3), for people; empty where none is."""
    count = int((before != after).any(axis=1).sum())
    return _nodes(count, "were", "was") if count else ""


def _nodes(count: int, several: str = "are", one: str = "is") -> str:
    """So many nodes, and what they do."""
    return f"{count} nodes {several}" if count > 1 else f"{count} node {one}"
