"""How far solutions are from each other: the norms in which errors are reported."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from restshape_studies.accuracy.state import Sampled, State

CLOSE = 0.01
"""Modes whose values differ by less than this share may mix: shapes are compared with all that such modes span."""

NAMES = {
    "motion": "displacement and velocity in the energy norm",
    "energy": "solution in the energy norm",
    "strain": "stretch and bending in the energy norm",
    "l2": "solution in the L2 norm",
    "frequencies": "frequencies (the worst mode)",
    "load_factors": "load factors (the worst mode)",
    "shapes": "shapes of the modes (the worst)",
}
"""Measures of the field's error, for people."""


@dataclass(frozen=True)
class Reference:
    """A solution far finer than all others, at the centroids of its cells.

    Args:
        points: (m, 2) [m]; weights: (m,) areas [m^2]; regions: (m,) of the shape that they lie in.
        stiffness: (m, 4) lambda, mu, thickness, mass; empty without a displacement, and of cloth.
        outline: (k, 2) control points of the shape [m].
        spectrum: as in `State`.
        solution: at these points.
        sheet: (m, 2, 3, 3) stiffness of cloth, as in `State`, else None.
    """

    points: np.ndarray
    weights: np.ndarray
    regions: np.ndarray
    stiffness: np.ndarray
    outline: np.ndarray
    spectrum: str
    solution: Sampled
    sheet: np.ndarray | None = None

    @classmethod
    def of(cls, state: State) -> Reference:
        """A state as the reference."""
        places = state.grid.centroids()
        stiffness = np.empty((0, 4)) if state.stiffness is None else state.stiffness
        points = places.points(state.grid)
        solution = Sampled.of(state, places)
        return cls(
            points, places.area, state.grid.regions, stiffness, state.outline, state.spectrum, solution, state.sheet
        )

    def sampled(self, state: State) -> Sampled:
        """Another solution at the same points."""
        return Sampled.of(state, state.grid.locate(self.points, self.regions))

    def same_shape(self, state: State) -> bool:
        """Whether another solution is one of the same shape."""
        mine, other = self.outline, state.outline
        return mine.shape == other.shape and bool(np.allclose(mine, other, rtol=0.0, atol=1e-9 * np.ptp(mine)))

    def distances(self, a: Sampled, b: Sampled) -> dict[str, float]:
        """By measure how far two solutions are from each other, relative to the reference; the main one comes first."""
        found: dict[str, float] = {}
        whole = self.solution
        if self.spectrum:
            found[self.spectrum] = spectral(whole.values, a.values, b.values)
        if whole.v is not None and len(self.stiffness):
            apart = np.hypot(self._energy(a.strain - b.strain), self._kinetic(a.v - b.v))
            found["motion"] = _ratio(float(apart), float(np.hypot(self._energy(whole.strain), self._kinetic(whole.v))))
        if whole.curvature is not None:
            apart = self._bent(a.strain - b.strain, a.curvature - b.curvature)
            found["strain"] = _ratio(apart, self._bent(whole.strain, whole.curvature))
        elif whole.u is not None and len(self.stiffness):
            found["energy"] = _ratio(self._energy(a.strain - b.strain), self._energy(whole.strain))
        if whole.u is not None:
            found["l2"] = _ratio(self._l2(a.u - b.u), self._l2(whole.u))
        if self.spectrum:
            found["shapes"] = self._shapes(a, b)
        return found

    def _energy(self, strain: np.ndarray) -> float:
        """The energy norm of strains (m, 2, 2): the root of twice their energy [sqrt(J)]."""
        lame, shear, thickness, _ = self.stiffness.T
        trace = strain[:, 0, 0] + strain[:, 1, 1]
        density = lame * trace**2 + 2.0 * shear * (strain**2).sum(axis=(1, 2))
        return float(np.sqrt(max(0.0, self.weights @ (thickness * density))))

    def _bent(self, strain: np.ndarray, curvature: np.ndarray) -> float:
        """The energy norm [sqrt(J)] of strains (m, 2, 2) and curvatures (m, 3, 3) of cloth."""
        vector = np.stack([strain[:, 0, 0], strain[:, 1, 1], 2.0 * strain[:, 0, 1]], axis=1)
        membrane, bending = self.sheet.swapaxes(0, 1)
        density = np.einsum("mi,mij,mj->m", vector, membrane, vector)
        density += np.einsum("mai,mij,maj->m", curvature, bending, curvature)
        return float(np.sqrt(max(0.0, self.weights @ density)))

    def _kinetic(self, v: np.ndarray) -> float:
        """The root of twice the kinetic energy [sqrt(J)] of a velocity (m, 2)."""
        return float(np.sqrt((self.weights * self.stiffness[:, 3]) @ (v**2).sum(axis=1)))

    def _l2(self, u: np.ndarray) -> float:
        return float(np.sqrt(self.weights @ (u**2).sum(axis=1)))

    def _shapes(self, a: Sampled, b: Sampled) -> float:
        """The worst part of a mode of `a` that lies outside of what the modes of `b` of about its value span."""
        worst = 0.0
        for value, shape in zip(a.values, a.shapes):
            if not len(b.shapes):
                return 1.0
            mine = np.abs(b.values[: len(b.shapes)] - value) <= CLOSE * abs(value)
            if not mine.any():
                mine[np.argmin(np.abs(b.values[: len(b.shapes)] - value))] = True
            weight = np.sqrt(self.weights)[:, None]
            target = (shape * weight).ravel()
            basis, _ = np.linalg.qr(np.stack([(other * weight).ravel() for other in b.shapes[mine]], axis=1))
            rest = target - basis @ (basis.T @ target)
            worst = max(worst, float(np.linalg.norm(rest) / np.linalg.norm(target)))
        return worst

    # --- files ----------------------------------------------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write this reference into a file (.npz)."""
        solution = self.solution
        none = np.empty(0)
        np.savez(
            path,
            points=self.points,
            weights=self.weights,
            regions=self.regions,
            stiffness=self.stiffness,
            outline=self.outline,
            spectrum=np.array(self.spectrum),
            u=none if solution.u is None else solution.u,
            strain=none if solution.strain is None else solution.strain,
            v=none if solution.v is None else solution.v,
            curvature=none if solution.curvature is None else solution.curvature,
            sheet=none if self.sheet is None else self.sheet,
            values=solution.values,
            shapes=solution.shapes,
            names=np.array(list(solution.quantities), dtype=str),
            quantities=np.array(list(solution.quantities.values()), dtype=float),
        )

    @classmethod
    def load(cls, path: Path) -> Reference:
        """The reference in a file."""
        with np.load(path) as data:
            entries = {name: data[name] for name in data.files}
        names = ("u", "strain", "v", "curvature", "sheet")
        u, strain, v, curvature, sheet = (entries[name] if entries[name].size else None for name in names)
        quantities = dict(zip(entries["names"].tolist(), entries["quantities"].tolist()))
        solution = Sampled(u, strain, v, entries["values"], entries["shapes"], quantities, curvature)
        geometry = (entries[name] for name in ("points", "weights", "regions", "stiffness", "outline"))
        return cls(*geometry, str(entries["spectrum"]), solution, sheet)


def spectral(scale: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    """The largest difference of values, k by k, relative to `scale`; 1 where one of both has a value more."""
    count = min(len(scale), len(a), len(b))
    more = 1.0 if max(len(a), len(b)) > count else 0.0
    if not count:
        return more
    return max(more, float(np.max(np.abs(a[:count] - b[:count]) / np.abs(scale[:count]))))


def _ratio(part: float, whole: float) -> float:
    """Part over whole; the part itself where the whole is nothing."""
    return part / whole if whole > 0.0 else part
