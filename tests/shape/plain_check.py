"""A slow check of shapes, written apart from the library: every piece against every other."""

import numpy as np

PIECES = 60
"""Of each edge."""
FINER = 400
"""Finer pieces for one of them, about places where such pieces cross."""


def fault(outline) -> str | None:
    """What is wrong with a shape by brute force over fine straight pieces; None when nothing is."""
    chains = [outline.point(e, np.linspace(0, 1, PIECES + 1)) for e in range(len(outline.edges))]
    a, b = (np.concatenate([chain[k : k + PIECES] for chain in chains]) for k in (0, 1))
    i, j = np.triu_indices(len(a), 1)
    for k in np.flatnonzero(cuts(a[i], b[i], a[j], b[j])):
        one, other = (divmod(int(piece), PIECES) for piece in (i[k], j[k]))
        # Straight pieces of curves that nearly touch may cross where the curves do not.
        if cross_closely(outline, one, other):
            return f"edges {one[0]} and {other[0]} cross"
    rings = []
    for loop in outline.loops:
        ring = np.concatenate([chains[e][:-1] if forward else chains[e][:0:-1] for e, forward in loop.edges])
        area = 0.5 * np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - np.roll(ring[:, 0], -1) * ring[:, 1])
        if area * (-1 if loop.kind == "hole" else 1) <= 0:
            return f"loop {loop.name} is turned"
        rings.append(ring)
    for k, loop in enumerate(outline.loops[1:], 1):
        if not winds(rings[0], rings[k][0]):
            return f"{loop.name} is outside"
        for m, other in enumerate(outline.loops[1:], 1):
            if m != k and other.kind == "hole" and winds(rings[m], rings[k][0]):
                return f"{loop.name} is inside {other.name}"
    return None


def cuts(a, b, p, q):
    """Whether pieces a b and p q cross; those with a common end do not."""
    common = np.zeros(len(a), dtype=bool)
    for one in (a, b):
        for other in (p, q):
            common |= np.abs(one - other).max(1) < 1e-12
    return ~common & apart(a, b, p, q) & apart(p, q, a, b)


def cross_closely(outline, one, other) -> bool:
    """Whether two edges cross about these pieces of them, by pieces that are finer by a factor of 400."""
    fine = []
    for edge, piece in (one, other):
        low, high = max(piece - 1, 0) / PIECES, min(piece + 2, PIECES) / PIECES
        fine.append(outline.point(edge, np.linspace(low, high, 1 + FINER * round((high - low) * PIECES))))
    i, j = (grid.ravel() for grid in np.meshgrid(*(np.arange(len(chain) - 1) for chain in fine), indexing="ij"))
    return bool(cuts(fine[0][i], fine[0][i + 1], fine[1][j], fine[1][j + 1]).any())


def apart(a, b, p, q):
    """Whether p and q lie on different sides of the line a b, rounding errors aside."""
    one, other = side(a, b, p), side(a, b, q)
    return (np.minimum(one, other) < -1e-13) & (np.maximum(one, other) > 1e-13)


def side(a, b, p):
    """Twice the signed area of the triangles a b p."""
    return (b[:, 0] - a[:, 0]) * (p[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (p[:, 0] - a[:, 0])


def winds(ring, p) -> bool:
    """Whether a ring goes round a point, by the sum of the angles."""
    z = (ring - p) @ np.array([1, 1j])
    return abs(np.angle(np.roll(z, -1) / z).sum()) > np.pi
