"""The shape of a mannequin: tubes for trunk, neck, head, arms in A-pose, legs and feet, joined smoothly.

It stands on the plane z = 0, faces -y, and x = 0 is its plane of symmetry.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from restshape.errors import UserError
from restshape.physics.cloth.mannequin.tube import Section, Tube, blended, section
from restshape.scene.body_sizes import Sizes

LEVELS = {"hip": 0.515, "waist": 0.62, "bust": 0.715, "shoulder": 0.81}
"""Levels at which measures hold, over the height."""
SLOPE = np.radians(48.0)
"""Angle of the arms from the vertical."""
SOLE = 0.01
"""Reach of the rounding between the sole and the rest of the foot [m]."""
FAR = 0.03
"""Distance over the height beyond which parts do not count for each other: more than any reach."""
MIDDLE = (0.0, 0.0)
CHEST = ("bust", "arms", "--shoulder", "give wider shoulders, a smaller bust or smaller upper arms")
HIPS = ("hip", "legs", "--thigh", "give smaller thighs or wider hips")


class BodyShape:
    """Distances from a mannequin.

    Args:
        sizes: of the body, all of them.

    Raises:
        UserError: arms or legs are so thick that a girth would not be that of the trunk alone.
    """

    def __init__(self, sizes: Sizes) -> None:
        self.sizes, self.height = sizes, sizes.height
        self.reaches = {"arms": 0.018 * sizes.height, "legs": 0.018 * sizes.height}
        self.trunk = self._trunk()
        self.upper = [self._neck(), self._head()]
        self.legs = [part for side in (1.0, -1.0) for part in (self._leg(side), self._foot(side))]
        self.arms: list[Tube] = []
        self.arms = self._arms(self._arm_root())
        for words in (CHEST, HIPS):
            self._check_apart(*words)

    def level(self, name: str) -> float:
        """The height [m] at which a measure holds."""
        return LEVELS[name] * self.height

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """The distance (...) from the surface at places (..., 3) [m], negative inside; near 0 alone that of a ruler."""
        found = self.trunk(places)
        for part in self.upper:
            found = blended(found, part(places), 0.018 * self.height)
        for part in self.arms:
            found = blended(found, part(places), self.reaches["arms"])
        for part in self.legs:
            found = blended(found, part(places), self.reaches["legs"])
        return -blended(-found, places[..., 2], SOLE)

    @property
    def parts(self) -> list[Tube]:
        """All tubes, in an order that is the same for all bodies."""
        return [self.trunk, *self.upper, *self.legs, *self.arms]

    def taken_to(self, other: BodyShape, places: np.ndarray) -> np.ndarray:
        """Where places (n, 3) [m] near this body are on one of other sizes: at the same shares of its parts.

        Between parts it is the mean of what each of them leads to, by how near they are.
        """
        away = np.stack([part.reach(places) for part in self.parts])
        near = np.maximum(0.0, 1.0 - (away - away.min(axis=0)) / (FAR * self.height)) ** 3
        found = np.stack([one.taken_to(two, places) for one, two in zip(self.parts, other.parts)])
        return np.einsum("kn,kna->na", near / near.sum(axis=0), found)

    def _trunk(self) -> Tube:
        s, h = self.sizes, self.height
        neck, belly = s.neck / (2.0 * np.pi), 0.5 + 0.3 * np.clip(s.waist / s.hip - 0.8, 0.0, 0.25)
        chest = float(np.clip(1.28 * (2.2 * s.shoulder / s.bust) ** 1.5, 0.95, 1.28))
        rows = [
            (0.475 * h, section(0.93 * s.hip, 1.32, 0.46)),
            (self.level("hip"), section(s.hip, 1.36, 0.46)),
            (0.565 * h, section(0.3 * s.waist + 0.7 * s.hip, 1.36, 0.5 * (belly + 0.46))),
            (self.level("waist"), section(s.waist, 1.32, belly)),
            (0.668 * h, section(0.5 * s.waist + 0.48 * s.bust, 1.32, 0.52)),
            (self.level("bust"), section(s.bust, chest, 0.55)),
            (0.765 * h, (0.5 * s.shoulder - 0.022 * h, 0.105 * s.bust + 0.008 * h, 0.115 * s.bust + 0.012 * h)),
            (0.80 * h, (0.5 * s.shoulder - 0.016 * h, 0.05 * h, 0.055 * h)),
            (0.822 * h, (0.34 * s.shoulder, 0.042 * h, 0.047 * h)),
            (0.84 * h, (1.15 * neck, 1.1 * neck, 1.2 * neck)),
        ]
        return Tube([(z, MIDDLE, half) for z, half in rows], (0.035 * h, 0.02 * h), FAR * h)

    def _neck(self) -> Tube:
        h, radius = self.height, self.sizes.neck / (2.0 * np.pi)
        rows = [(0.80, 0.0, 1.1), (0.845, 0.0, 1.0), (0.885, -0.006, 1.0)]
        return Tube([(z * h, (0.0, y * h), (r * radius,) * 3) for z, y, r in rows], (0.02 * h, 0.02 * h), FAR * h)

    def _head(self) -> Tube:
        h, centre = self.height, (0.0, -0.007 * self.height)
        rows = [
            (0.90, (0.034, 0.048, 0.036)),
            (0.94, (0.045, 0.055, 0.055)),
            (0.955, (0.0455, 0.0555, 0.0575)),
        ]
        return Tube([(z * h, centre, _times(h, half)) for z, half in rows], (0.03 * h, 0.045 * h), FAR * h)

    def _arms(self, root: float) -> list[Tube]:
        """Both arms, whose axes begin at this distance [m] from the plane of symmetry."""
        h, r = self.height, self.sizes.upper_arm / (2.0 * np.pi)
        rows = [
            (0.0, (1.1 * r,) * 3),
            (0.07 * h, (1.02 * r,) * 3),
            (0.12 * h, (r,) * 3),
            (0.18 * h, (0.85 * r,) * 3),
            (0.215 * h, (0.87 * r,) * 3),
            (0.33 * h, _times(h, (0.0155, 0.0175, 0.0175))),
            (0.37 * h, _times(h, (0.013, 0.025, 0.025))),
            (0.41 * h, _times(h, (0.0105, 0.022, 0.022))),
        ]
        found = []
        for side in (1.0, -1.0):
            along, deep = np.array([side * np.sin(SLOPE), 0.0, -np.cos(SLOPE)]), np.array([0.0, 1.0, 0.0])
            axes = np.stack([np.cross(deep, along), deep, along])
            origin = (side * root, 0.0, self.level("shoulder") - 0.7 * r)
            found.append(Tube([(z, MIDDLE, half) for z, half in rows], (r, 0.025 * h), FAR * h, origin, axes))
        return found

    def _arm_root(self) -> float:
        """Where the arms begin, so that the width at the level of the shoulders is as wanted."""
        half = 0.5 * self.sizes.shoulder
        line = np.array([[half, y, self.level("shoulder")] for y in np.linspace(-0.05, 0.05, 41) * self.height])

        def outside(root: float) -> float:
            self.arms = self._arms(root)
            return float(self(line).min())

        return float(brentq(outside, 0.2 * half, half, xtol=1e-6))

    def _leg(self, side: float) -> Tube:
        h, r = self.height, self.sizes.thigh / (2.0 * np.pi)
        top = min(0.97 * r, self.trunk.along(self.level("hip"))[2] - 1.04 * r)
        rows = [
            (0.035, 0.075 * h, 0.006, _times(h, (0.0205, 0.025, 0.025))),
            (0.06, 0.075 * h, 0.006, _times(h, (0.019, 0.023, 0.023))),
            (0.20, 0.074 * h, 0.004, (0.45 * r + 0.01 * h,) * 3),
            (0.275, 0.072 * h, 0.0, (0.5 * r + 0.006 * h,) * 3),
            (0.38, 0.4 * (0.072 * h) + 0.6 * top, 0.0, (0.86 * r,) * 3),
            (0.435, top, 0.0, (r,) * 3),
            (0.465, top, 0.0, (0.93 * r,) * 3),
        ]
        return Tube([(z * h, (side * x, y * h), half) for z, x, y, half in rows], (0.02 * h, 0.022 * h), FAR * h)

    def _foot(self, side: float) -> Tube:
        h = self.height
        rows = [
            (-0.018 * h, MIDDLE, (0.019 * h,) * 3),
            (0.05 * h, MIDDLE, _times(h, (0.025, 0.021, 0.022))),
            (0.105 * h, MIDDLE, _times(h, (0.026, 0.021, 0.010))),
        ]
        axes = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
        return Tube(rows, (0.018 * h, 0.022 * h), FAR * h, (side * 0.075 * h, 0.006 * h, 0.02 * h), axes)

    def _check_apart(self, name: str, limbs: str, where: str, do: str) -> None:
        """Refuses limbs that are within their reach of the trunk's girth at a level."""
        level = self.level(name)
        _, _, half, front, back = self.trunk.along(level)
        angle = np.linspace(0.0, 2.0 * np.pi, 181)
        y = np.where(np.sin(angle) < 0.0, front, back) * np.sin(angle)
        ring = np.column_stack([half * np.cos(angle), y, np.full_like(angle, level)])
        if min(float(part(ring).min()) for part in getattr(self, limbs)) < self.reaches[limbs]:
            raise UserError(f"the {limbs} of this body meet its trunk at the level of the {name}", where, do)


def _times(factor: float, half: Section) -> Section:
    return factor * half[0], factor * half[1], factor * half[2]
