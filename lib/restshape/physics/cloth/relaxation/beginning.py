"""Where cloth begins: as the scene places it, then out of bodies, and each layer outside of those below."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.mesh.relocate import HarmonicExtension
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.layer_order import ROOM, WIDENINGS, WIDER
from restshape.physics.cloth.out_of_bodies import brought_out
from restshape.physics.cloth.scene import ClothArguments
from restshape.physics.cloth.squeezed import refuse_squeezed
from restshape.physics.cloth.trust import penetration_notes
from restshape.physics.cloth.tunnelling import penetrations
from restshape.scene.model import Scene


@dataclass(frozen=True, eq=False)
class Beginning:
    """Where cloth begins.

    Args:
        x: (n, 3) unknowns.
        placed: (corners, 3) [m] as the scene has it; out: out of bodies; ordered: with its layers in order.
    """

    x: np.ndarray
    placed: np.ndarray
    out: np.ndarray
    ordered: np.ndarray


def initial_positions(problem: ClothProblem, arguments: ClothArguments) -> np.ndarray:
    """Unknowns (n, 3) at which cloth begins, with supports where they are at first."""
    return beginning(problem, arguments).x


def beginning(problem: ClothProblem, arguments: ClothArguments) -> Beginning:
    """Where cloth begins, with supports where they are at first."""
    x = _placed(problem, arguments)
    placed = out = problem.corners(x)
    movable = ~arguments.supports.mask.any(axis=1)
    if problem.contact:
        out = brought_out(problem.contact.bodies, placed, problem.mesh.cells, movable, problem.contact.thickness)
    ordered = _ordered(problem, out, movable)
    moved = not np.array_equal(ordered, placed)
    return Beginning(problem.flat(ordered) if moved else x, placed, out, ordered)


def _ordered(problem: ClothProblem, x: np.ndarray, movable: np.ndarray) -> np.ndarray:
    """Places (n, 3) [m] of the corners with layers in order, at so large a distance that they do not cross."""
    layers, contact = problem.ordered_layers, problem.self_contact
    if layers is None or contact is None:
        return x
    gap = ROOM * contact.values.thickness
    for _ in range(WIDENINGS):
        found = layers.in_order(x, movable, gap)
        if not problem.surface.crosses(found):
            break
        gap *= WIDER
    return found


def _placed(problem: ClothProblem, arguments: ClothArguments) -> np.ndarray:
    """Unknowns (n, 3) of the initial placement as the scene has it, with supports where they are at first.

    Supports that would go through the flat cloth on their way there draw it along, the less the farther it is.
    """
    x = problem.flat(arguments.start)
    ways = arguments.start - arguments.placed
    if not problem.self_contact or not ways.any() or not problem.surface.crosses(problem.corners(x)):
        return x
    constrained = np.flatnonzero(arguments.supports.mask.any(axis=1)).astype(np.int32)
    drawn = arguments.placed + HarmonicExtension(problem.mesh, constrained).adapted(ways[constrained])
    return problem.flat(np.where(arguments.supports.mask, arguments.start, drawn))


def start_notes(problem: ClothProblem, begun: Beginning, scene: Scene) -> list[str]:
    """What there is to note of bodies, and of layers, where a scene places its cloth.

    Raises:
        UserError: two bodies hold it between them.
    """
    found = []
    if problem.contact:
        refuse_squeezed(problem.contact, begun.placed, scene.bodies)
        found = penetration_notes("begins", problem, scene, penetrations(problem.contact, begun.placed))
        out = _moved(begun.placed, begun.out)
        found = [f"{note}: {out} put outside, the nearest way" if out else note for note in found]
    if ordered := _moved(begun.out, begun.ordered):
        found.append(f"{ordered} put outside of lower layers")
    return found


def _moved(before: np.ndarray, after: np.ndarray) -> str:
    """How many nodes are elsewhere after than before (n, 3), for people; empty where none is."""
    count = int((before != after).any(axis=1).sum())
    return f"{count} nodes were" if count > 1 else "1 node was" if count else ""
