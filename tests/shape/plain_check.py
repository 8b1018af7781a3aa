"""A slow check of shapes, written apart from the library: every piece against every other."""

import numpy as np


def fault(outline) -> str | None:
    """What is wrong with a shape by brute force over fine straight pieces; None when nothing is."""
    chains = [outline.point(e, np.linspace(0, 1, 60)) for e in range(len(outline.edges))]
    first, second, owner = [], [], []
    for e, chain in enumerate(chains):
        first.append(chain[:-1])
        second.append(chain[1:])
        owner += [e] * (len(chain) - 1)
    a, b, owner = np.concatenate(first), np.concatenate(second), np.array(owner)
    i, j = np.triu_indices(len(a), 1)
    common = (np.abs(a[i] - b[j]).max(1) < 1e-12) | (np.abs(b[i] - a[j]).max(1) < 1e-12)
    common |= (np.abs(a[i] - a[j]).max(1) < 1e-12) | (np.abs(b[i] - b[j]).max(1) < 1e-12)
    i, j = i[~common], j[~common]
    cut = apart(a[i], b[i], a[j], b[j]) & apart(a[j], b[j], a[i], b[i])
    if cut.any():
        k = int(cut.argmax())
        return f"edges {owner[i[k]]} and {owner[j[k]]} cross"
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
