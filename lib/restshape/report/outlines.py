"""Triangles and their border as lines to draw; curved where they are of second order."""

import numpy as np

PIECES = 4
"""Straight pieces of a second-order side."""


def polygons(x: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The corners (ne, k, 2) of polygons that show cells.

    Args:
        x: (n, 2) places of the nodes.
        cells: (ne, 3), or (ne, 6) with the middles of the sides (0, 1), (1, 2), (2, 0) last.
    """
    if cells.shape[1] == 3:
        return x[cells]
    sides = np.stack([cells[:, [i, (i + 1) % 3, 3 + i]] for i in range(3)], axis=1)
    return lines(x, sides.reshape(-1, 3))[:, :-1].reshape(len(cells), -1, 2)


def lines(x: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Points (m, k, 2) from end to end of sides (m, 2), or (m, 3) with their middles last."""
    if sides.shape[1] == 2:
        return x[sides]
    s = np.linspace(0.0, 1.0, PIECES + 1)
    basis = np.stack([(1.0 - s) * (1.0 - 2.0 * s), s * (2.0 * s - 1.0), 4.0 * s * (1.0 - s)], axis=1)
    return basis @ x[sides]


def sides(cells: np.ndarray) -> np.ndarray:
    """All sides (m, 2), or (m, 3) with their middles, of cells (ne, 3) or (ne, 6), each of them once."""
    return _sides(cells)[0]


def border(cells: np.ndarray) -> np.ndarray:
    """The sides (m, 2), or (m, 3) with their middles, that belong to one cell (ne, 3) or (ne, 6) only."""
    all_sides, counts = _sides(cells)
    return all_sides[counts == 1]


def chains(x: np.ndarray, around: np.ndarray) -> list[np.ndarray]:
    """The lines (k, 2) that sides of a border make together, along which dashes go on from side to side.

    Args:
        x: (n, 2) places of the nodes.
        around: (m, 2) or (m, 3) of `border`; lines that are closed end where they begin.
    """
    drawn, at = lines(x, around), dict[int, list[int]]()
    ends = around[:, :2].tolist()
    for side, pair in enumerate(ends):
        for node in pair:
            at.setdefault(node, []).append(side)
    left, found = dict.fromkeys(range(len(ends))), []
    while left:
        side, parts = next(iter(left)), []
        node = ends[side][0]
        while side in left:
            del left[side]
            forward = ends[side][0] == node
            parts.append(drawn[side][:: 1 if forward else -1][bool(parts) :])
            node = ends[side][forward]
            side = next((other for other in at[node] if other in left), side)
        found.append(np.concatenate(parts))
    return found


def _sides(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sides, and how many cells have each."""
    ends = np.sort(cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64), axis=1)
    _, first, counts = np.unique(ends[:, 0] << 32 | ends[:, 1], return_index=True, return_counts=True)
    return (ends if cells.shape[1] == 3 else np.column_stack([ends, cells[:, 3:].ravel()]))[first], counts
