"""How far joints and feet of a piece are from being closed: smooth numbers that are zero where all are."""

import numpy as np
from restshape_apps.furniture.physics.furniture import Furniture

AIM = 2e-3
"""How far inside what is asked for a lost joint is to come [m]."""

ACROSS = 0.1
"""Least cosine between the line of an end and an axis of its face for that line to run across its sides."""


class Opening:
    """Openings of the joints, feet and planks of a piece, as its design changes.

    Those that have a fault at the piece as it is must come `AIM` further in than is asked for.

    Args:
        furniture: the model of the piece.
    """

    def __init__(self, furniture: Furniture) -> None:
        self.furniture, piece = furniture, furniture.piece
        geometry, asked = furniture.geometry(), furniture.compliance
        self.i, self.side, self.j, self.face = (
            np.array([getattr(joint, name) for joint in piece.joints], dtype=int) for name in ("i", "side", "j", "face")
        )
        self.feet = [(foot.plank, foot.side // 2, np.array(piece.planes[foot.plane].normal)) for foot in piece.feet]
        self.aim = np.where(np.array(geometry.joint_faults, dtype=int) > 0, AIM, 0.0)
        self.overlap, self.slant = asked.least_overlap, asked.least_slant
        self.size = piece.size

    def at(self, gamma: np.ndarray) -> np.ndarray:
        """The openings (r,) [m] at design parameters (n, 8); slants count in parts of the piece's size."""
        raw = self.furniture.kernel.shape(gamma)
        centre, axes, size = raw["centre"], raw["axes"], raw["size"]
        short = np.maximum(self.overlap + AIM - size[:, :2], 0.0).ravel()
        feet = [part for foot in self.feet for part in self._foot(axes, size, *foot)]
        return np.concatenate([short, feet, *(self._joints(centre, axes, size) if len(self.i) else ())])

    def _foot(self, axes: np.ndarray, size: np.ndarray, p: int, axis: int, normal: np.ndarray) -> list[float]:
        """How far a foot is from standing flat: tilts of the sides that lie on the floor, and its lean."""
        flat = [a for a in range(2) if a != axis]
        tilts = [0.5 * float(size[p, a]) * float(axes[p, :, a] @ normal) for a in flat]
        lean = self.slant - abs(float(axes[p, :, axis] @ normal))
        return [*tilts, self.size * max(lean, 0.0) if axis < 2 else 0.0]

    def _joints(self, centre: np.ndarray, axes: np.ndarray, size: np.ndarray) -> list[np.ndarray]:
        """How far joints are from being flush, upright enough, and long enough on their faces."""
        k, axis, along = np.arange(len(self.i)), self.side // 2, 1 - self.side // 2
        own, other = axes[self.i], axes[self.j]
        x, y, half = own[k, :, axis], own[k, :, along], 0.5 * size[self.i, along]
        end = centre[self.i] + x * (np.where(self.side % 2, 0.5, -0.5) * size[self.i, axis])[:, None]
        normal = other[:, :, 2]
        tilt = half * np.einsum("ka,ka->k", y, normal)
        lean = self.size * np.maximum(self.slant - np.abs(np.einsum("ka,ka->k", x, normal)), 0.0)
        q, d = (np.einsum("kab,ka->kb", other, v)[:, :2] for v in (end - centre[self.j], y))
        edge = 0.5 * size[self.j, :2]
        # A side of the face that the end's line runs across cuts it; beside one that it runs along there is nothing.
        across = np.abs(d) > ACROSS
        beside = np.maximum(np.abs(q) - edge - np.abs(d) * half[:, None] + self.aim[:, None], 0.0)
        beside = np.where(across, 0.0, beside)
        crosses = across | ((np.abs(d) > 1e-9) & (beside <= self.aim[:, None]))
        safe = np.where(crosses, d, 1.0)
        ends = np.sort(np.stack([(-edge - q) / safe, (edge - q) / safe]), axis=0)
        low = np.maximum(-half, np.where(crosses, ends[0], -np.inf).max(axis=1))
        high = np.minimum(half, np.where(crosses, ends[1], np.inf).min(axis=1))
        short = np.maximum(self.overlap + self.aim - (high - low), 0.0)
        return [tilt, lean, beside.ravel(), short]
