"""Pieces of cloth that nothing holds: no support, no body, and no cloth that they are sewn to or lie on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from restshape.mesh.mesh import Mesh

FALLS = "nothing catches the cloth: it falls without end"


class FreeCloth(Protocol):
    """What is asked of cloth.

    Attributes:
        mesh: of its corners.
        supports: where it is constrained; g: (3,) acceleration [m/s^2].
        contact: with bodies; self_contact: with itself; seams: what is sewn together; each None where there is none.
    """

    mesh: Mesh
    supports: Any
    g: np.ndarray
    contact: Any
    self_contact: Any
    seams: Any


def falling_pieces(problem: FreeCloth, corners: np.ndarray) -> tuple[str, ...]:
    """Names of the pieces at corners (n, 3) [m] that fall without end; of one sheet without panels "outline".

    A piece may still come to lie on cloth that is farther along its way, unless that falls too.
    """
    mesh = problem.mesh
    several = len(mesh.outline.piece_names) > 1
    group = joined_pieces(problem) if several else np.zeros(1, dtype=np.int64)
    of_node = group[mesh.node_piece] if several else np.zeros(len(corners), dtype=np.int64)
    ways = {k: np.where(problem.supports.mask[of_node == k].any(axis=0), 0.0, problem.g) for k in np.unique(group)}
    loose = {k for k, way in ways.items() if _passed(problem, corners[of_node == k], way)}
    while problem.self_contact:
        others = corners[~np.isin(of_node, list(loose))]
        caught = {k for k in loose if len(others) and _reaches(corners[of_node == k], others, ways[k])}
        if not caught:
            break
        loose -= caught
    return tuple(name for name, k in zip(mesh.outline.piece_names, group) if k in loose)


def _passed(problem: FreeCloth, corners: np.ndarray, way: np.ndarray) -> bool:
    """Whether cloth at corners (n, 3) is free to go a way (3,), and meets no body on it."""
    return bool(way.any()) and (not problem.contact or problem.contact.passed(corners, way))


def _reaches(corners: np.ndarray, others: np.ndarray, way: np.ndarray) -> bool:
    """Whether cloth at corners (n, 3) has some of the others (m, 3) before it on its way (3,)."""
    return (others @ way).max() > (corners @ way).min()


def joined_pieces(problem: FreeCloth) -> np.ndarray:
    """For each piece the number (pieces,) of the first one that seams join it to."""
    group = np.arange(len(problem.mesh.outline.piece_names))
    pieces = problem.mesh.node_piece
    for pair in problem.seams.pairs if problem.seams else ():
        joined = np.unique(group[pieces[np.concatenate([pair.first.nodes, pair.second.nodes])]])
        group[np.isin(group, joined)] = joined[0]
    return group


def why_it_falls(pieces: Sequence[str], among: int) -> str:
    """Why cloth that falls does not converge: all of it does, or these of so many pieces."""
    if len(pieces) == among:
        return FALLS
    return f"nothing catches {', '.join(pieces)}: {'it falls' if len(pieces) == 1 else 'they fall'} without end"
