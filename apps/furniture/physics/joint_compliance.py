"""How the utilisation of joints depends on what nobody knows: the ratios of the compliances of joints and floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from restshape_apps.furniture import _kernels
from restshape_apps.furniture.physics import plank_findings
from restshape_apps.furniture.physics.furniture import ALL, UNSTABLE, WEAK, Compliance, Furniture
from restshape_apps.furniture.physics.plank_findings import MOST_UTILISATION, joint_planks
from restshape_apps.furniture.shape.planks import Piece

from restshape.findings import Finding

DECADES = (1.0, 10.0, 100.0, 1000.0)
"""Ratios of a joint's compliance in rotation and in translation [1/m^2], from that of the model on."""
FLOORS = (1.0, 1e-3)
"""Compliances of the floor, in parts of that of joints in translation."""
SPREAD = 0.01
"""Use of a joint that must differ between two ratios for the joint to count as redundant."""


@dataclass(frozen=True)
class UtilisationRange:
    """The utilisation of each joint's strength over all ratios of compliance.

    Args:
        low, high: (j,) least and largest utilisation, each the largest of all cases.
        changes: whether the piece bears its loads depends on the ratios.
    """

    low: np.ndarray
    high: np.ndarray
    changes: bool

    @cached_property
    def redundant(self) -> np.ndarray:
        """Numbers of the joints whose utilisation depends on the ratios."""
        return np.flatnonzero(self.high > self.low + SPREAD)

    def largest(self, most: int) -> list[int]:
        """Numbers of at most so many redundant joints, those with the largest utilisation first."""
        return sorted(self.redundant.tolist(), key=lambda k: -round(float(self.high[k]), 6))[:most]

    def findings(self, piece: Piece) -> tuple[Finding, ...]:
        """What decides whether the piece bears its loads: redundant joints that are weak at some ratios
        alone, the worst first. The springs' own displacements hardly change one that statics decides.

        The value is the largest utilisation, the bound the least.
        """
        if not self.changes:
            return ()
        worst = [k for k in self.largest(len(self.low)) if self.low[k] <= 1.0 < self.high[k]]
        return tuple(
            Finding(plank_findings.DEPENDS, "", joint_planks(piece, k), float(self.high[k]), float(self.low[k]))
            for k in worst
        )


def compliances(piece: Piece, nominal: Compliance) -> tuple[Compliance, ...]:
    """The compliances that are tried: all joints alike, from rotationally stiff to a line of fasteners at an edge.

    Such a line, half the thickness t from the edge about which it turns, makes the ratio 4 / t^2.
    """
    return _compliances(min((float(piece.planks[joint.i].size[2]) for joint in piece.joints), default=1.0), nominal)


@lru_cache(64)
def _compliances(thinnest: float, nominal: Compliance) -> tuple[Compliance, ...]:
    """Those of pieces whose thinnest plank [m] with an end in a joint is the same, as frames of a drag have them."""
    ratios = (*DECADES, max(4.0 / thinnest**2, DECADES[-1]))
    t = nominal.joint_t
    return tuple(replace(nominal, joint_r=ratio * t, floor=floor * t) for ratio in ratios for floor in FLOORS)


def utilisation_range(piece: Piece, nominal: Compliance) -> UtilisationRange | None:
    """The utilisation of joints of a piece over all ratios; None where its joints are open or it has no equilibrium.

    Ratios at which no equilibrium with unilateral contact is found are left out, where there are others.

    Source: docs/theory/furniture.md, "What compliance decides".
    """
    return utilisation_range_at(Furniture(piece, nominal), None)


def utilisation_range_at(furniture: Furniture, gamma: np.ndarray | None) -> UtilisationRange | None:
    """The same of the piece of a model at design parameters (n, 8); None: as it is."""
    springs = _springs(furniture, compliances(furniture.piece, furniture.compliance))
    flaws, utilisations, sprung = springs.test(gamma, ALL ^ WEAK ^ UNSTABLE)
    if flaws[-1] & (ALL ^ WEAK ^ UNSTABLE):
        return None
    if not all(sprung):
        solved = np.flatnonzero(~np.array(sprung))
        flaws, utilisations = [flaws[k] for k in solved], utilisations[solved]
    bears = [not one & WEAK for one in flaws]
    falls = any(one & UNSTABLE for one in flaws)
    return UtilisationRange(
        utilisations.min(axis=0), utilisations.max(axis=0), any(bears) and not all(bears) and not falls
    )


def _springs(furniture: Furniture, tried: Sequence[Compliance]) -> _kernels.Furniture.ManySprings:
    """The tests of a model with each of some compliances, whose other settings are those of the model."""
    numbers = np.array([(one.joint_t, one.joint_r, one.floor) for one in tried])
    return _kernels.Furniture.ManySprings(furniture.kernel, numbers)


class ComplianceModels:
    """Models of a piece with all compliances that are tried, by which its changes are judged without a new model each.

    Args:
        furniture: of the piece.
    """

    def __init__(self, furniture: Furniture) -> None:
        tried = compliances(furniture.piece, Compliance())
        # What differs most comes first, and a floor as stiff as joints, which takes fewer steps.
        outside_in = sorted(
            range(len(tried)), key=lambda k: (tried[k].floor < tried[k].joint_t, min(k, len(tried) - 1 - k))
        )
        self._springs = _springs(furniture, [tried[k] for k in outside_in])

    def forget(self) -> None:
        """Let the next equilibria be found from rest."""
        self._springs.forget()

    def decide(self, gamma: np.ndarray) -> bool:
        """Whether the compliance of redundant joints decides if the piece, valid at design parameters (n, 8), bears its
        loads: `utilisation_range` of the piece there has findings then.

        Equilibria are found from those of the last call: one that is near is soon answered.
        """
        return self._springs.decide(gamma, SPREAD)


def recorded_utilisations(piece: Piece, known: UtilisationRange, most: int) -> list[list[object]]:
    """Name, least and largest utilisation of redundant joints, the largest first, at most so many."""
    return [[" on ".join(joint_planks(piece, k)), *_rounded(known, k)] for k in known.largest(most)]


def _rounded(known: UtilisationRange, joint: int) -> Sequence[float]:
    # A single fastener bears no twist; JSON knows no infinite number.
    return [float(f"{min(utilisation[joint], MOST_UTILISATION):.4g}") for utilisation in (known.low, known.high)]
