"""Furniture: the compiled model of a piece, its tests, and what they found."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from restshape_apps.furniture import _kernels
from restshape_apps.furniture.physics import plank_findings
from restshape_apps.furniture.physics.fasteners import strengths, wood
from restshape_apps.furniture.physics.plank_findings import FlawNumbers
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.physics.sliding import ROUGH, friction_needed, mass_needed
from restshape_apps.furniture.shape.planks import CORNERS, Joint, Piece, parts_of

from restshape.errors import UserError
from restshape.findings import Finding
from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN

LOST, OVERLAPPING, UNSTABLE, WEAK, UNBALANCED, APART = 1, 2, 4, 8, 16, 32
ALL = LOST | OVERLAPPING | UNSTABLE | WEAK | UNBALANCED | APART
"""Flaws of a piece, as bits: a joint or foot is lost, planks overlap each other or the floor, it falls, a joint breaks,
no equilibrium, it is in parts."""
DOUBTFUL = 64
"""No flaw: moments that do not count overload a joint. Wanted beside `ALL`, there must be none."""


@dataclass(frozen=True)
class Compliance:
    """What the springs of the model yield, and tolerances of its geometry.

    Args:
        joint_t, joint_r, floor: [m/N], [rad/(N m)], [m/N]. Forces in redundant loops depend on their ratios alone.
        shift: of the diagonal of a tangent, in parts of the joints' stiffness.
        least_slant: least cosine between a plank and the normal of what its end meets.
        gap: of a closed joint [m].
        least_overlap: least length of a joint [m].
        interference: of planks that counts as touching [m].
    """

    joint_t: float = 1e-9
    joint_r: float = 1e-9
    floor: float = 1e-9
    shift: float = 1e-9
    least_slant: float = 0.25
    gap: float = 1e-6
    least_overlap: float = 0.01
    interference: float = plank_findings.INTERFERENCE


@dataclass(frozen=True)
class TestResult:
    """What a test found.

    A piece may hold and yet be doubtful: moments that do not count overload a joint.

    Args:
        flaws: bits; 0 is a valid piece.
        pull, shear: the largest utilisation of a joint's strength, in parts of it.
        unbalanced: the part of the loads that contacts cannot balance.
        found: which joints, planks and cases have the flaws; a quick test shows the first.
        piece: whose they are.
    """

    flaws: int
    pull: float
    shear: float
    unbalanced: float
    found: FlawNumbers = field(default_factory=FlawNumbers, compare=False)
    piece: Piece | None = field(default=None, compare=False, repr=False)

    @property
    def valid(self) -> bool:
        """Whether nothing is wrong."""
        return self.flaws == 0

    @property
    def doubts(self) -> tuple[Finding, ...]:
        """What overloads joints and is not counted, by names of planks, joints and loads."""
        return () if np.isinf(self.pull) else tuple(plank_findings.doubts(self.piece, self.found))

    @property
    def status(self) -> str:
        """The constraint status: "fails", "uncertain" where it holds but is doubtful, or "holds"."""
        return FAILS if not self.valid else UNCERTAIN if self.found.doubts else HOLDS

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is wrong, by names of planks, joints and loads."""
        found = plank_findings.apart(self.piece) if self.flaws & APART else []
        kinds = {LOST: plank_findings.lost, OVERLAPPING: plank_findings.overlapping}
        # Of a piece that cannot be closed nothing else is known.
        if not np.isinf(self.pull):
            kinds |= {UNSTABLE: self._falls, WEAK: plank_findings.weak, UNBALANCED: plank_findings.unbalanced}
        return (
            *found,
            *(one for bit, find in kinds.items() if self.flaws & bit for one in find(self.piece, self.found)),
        )

    def _falls(self, piece: Piece, found: FlawNumbers) -> list[Finding]:
        """What falls, and what only slides, with the friction that would hold it."""
        sliding = sliding_cases(piece, found)
        loads = Furniture(piece).loads() if sliding else np.empty((0, 3))
        needed = {case: friction_needed(piece, loads[case], case, falling_cases) for case in sliding}
        return plank_findings.falls(piece, found, needed)

    @property
    def words(self) -> tuple[str, ...]:
        """What is wrong, in words that name it; of a piece that holds what is doubtful."""
        return phrases(self.findings or self.doubts)


@dataclass(frozen=True)
class Forces:
    """Equilibrium of one case.

    Args:
        u: (n, 6) displacements [m] and rotation vectors [rad] of the planks.
        one_sided: contacts only push, and slide beyond Coulomb's limit; else they act as springs both ways.
        found: the equilibrium was found.
        contacts: (c, 3) forces on the planks [N], four of each foot.
        balance: (c, 3) forces inside the friction cones that balance the loads best [N].
        unbalanced: the part of the loads that these leave.
        tension, shear, bending: (j,) of each joint: T [N], (j, 2) h_x, h_y [N], h^r_y [N m].
        twist: (j, 2) moments about x and n [N m].
        pull_utilisation, shear_utilisation: (j,) in parts of the joint's strength.
        line_utilisation, twist_utilisation: (j,) the same by the moments about x and n, on the most loaded fastener.
    """

    u: np.ndarray
    one_sided: bool
    found: bool
    contacts: np.ndarray
    balance: np.ndarray
    unbalanced: float
    tension: np.ndarray
    shear: np.ndarray
    bending: np.ndarray
    twist: np.ndarray
    pull_utilisation: np.ndarray
    shear_utilisation: np.ndarray
    line_utilisation: np.ndarray
    twist_utilisation: np.ndarray
    moments: bool = False

    @cached_property
    def utilisation(self) -> np.ndarray:
        """The utilisation (j,) of each joint's strength, of all that counts."""
        counted = np.maximum(self.pull_utilisation, self.shear_utilisation)
        return np.maximum(counted, self.moment_utilisation) if self.moments else counted

    @cached_property
    def moment_utilisation(self) -> np.ndarray:
        """The utilisation (j,) of each joint's strength by the moments about x and n."""
        return np.maximum(self.line_utilisation, self.twist_utilisation)


@dataclass(frozen=True)
class Geometry:
    """The closed geometry of a piece.

    Args:
        centre, axes, size: (n, 3), (n, 3, 3), (n, 3) of the planks.
        mass: (n,) [kg].
        p, n, x, y: (j, 3) place and frame of each joint; n is the outward normal of the face, y runs along the joint.
        length: (j,) of each joint [m].
        nails: (j,) fasteners in it.
        contacts: (c, 3) points, four of each foot.
        joint_faults, foot_faults: numbers of `plank_findings.FAULTS`.
        overlaps: pairs of planks that pass through each other; a plank and -1 - k where it goes through plane k.
    """

    centre: np.ndarray
    axes: np.ndarray
    size: np.ndarray
    mass: np.ndarray
    p: np.ndarray
    n: np.ndarray
    x: np.ndarray
    y: np.ndarray
    length: np.ndarray
    nails: np.ndarray
    contacts: np.ndarray
    joint_faults: tuple[int, ...]
    foot_faults: tuple[int, ...]
    overlaps: tuple[tuple[int, int], ...]


class Furniture:
    """The model of a piece; design parameters gamma (n, 8) move its planks, and held ends follow.

    Args:
        piece: planks, joints, feet and loads.
        compliance: of the springs.

    Raises:
        UserError: a name is unknown, a fastener does not reach through its plank, or its strength there is not known.

    Source: docs/theory/furniture.md.
    """

    def __init__(self, piece: Piece, compliance: Compliance | None = None) -> None:
        if not piece.planks:
            raise UserError("the piece has no planks", piece.name, "add one")
        self.piece, self.compliance = piece, compliance or Compliance()
        planks, n = piece.planks, len(piece.planks)
        loads = (*piece.weights, *piece.pushes)
        self.strength = np.array([self._strength(joint) for joint in piece.joints]).reshape(-1, 2)
        self.lever = np.array([planks[joint.i].size[2] for joint in piece.joints])
        self.cases = self._cases(len(loads))
        parts = (
            np.array([plank.centre for plank in planks], dtype=float),
            np.array([plank.axes for plank in planks], dtype=float),
            np.array([plank.size for plank in planks], dtype=float),
            np.array([wood(plank.wood).density for plank in planks]),
            np.array([(joint.i, joint.side, joint.j, joint.face) for joint in piece.joints], dtype=np.int32),
            np.column_stack([np.full(len(piece.joints), piece.spacing), self.strength]),
            np.array([(foot.plank, foot.side, foot.plane) for foot in piece.feet], dtype=np.int32),
            np.array([(*plane.point, *plane.normal, plane.mu) for plane in piece.planes], dtype=float),
            np.array([load.plank for load in loads], dtype=np.int32),
            np.array([load.place for load in loads], dtype=float),
            self.cases,
            np.array(piece.gravity, dtype=float),
        )
        settings = [*vars(self.compliance).values(), float(piece.moments)]
        self.kernel = _kernels.Furniture(*parts, np.array(settings))
        self.count = n

    def _strength(self, joint: Joint) -> tuple[float, float]:
        into, through = self.piece.planks[joint.i], self.piece.planks[joint.j]
        return strengths(joint.fastener, into.wood, through.wood, float(through.size[2]), float(into.size[2]))

    def _cases(self, loads: int) -> np.ndarray:
        weights, pushes = self.piece.weights, self.piece.pushes
        cases = np.zeros((1 + len(pushes), loads, 3))
        for k, load in enumerate(weights):
            cases[:, k] = load.force
        for c, load in enumerate(pushes):
            cases[1 + c, len(weights) + c] = load.force
        return cases

    def test(self, gamma: np.ndarray | None = None, wanted: int = ALL, quick: bool = False) -> TestResult:
        """What the full test finds at design parameters (n, 8); with `quick` it ends at the first flaw wanted."""
        flaws, pull, shear, missing, *found = self.kernel.test(gamma, wanted, quick)
        return TestResult(flaws & ALL, pull, shear, missing, FlawNumbers(*found), self.piece)

    def geometry(self, gamma: np.ndarray | None = None) -> Geometry:
        """The closed geometry at design parameters (n, 8), with all overlaps."""
        raw = self.kernel.shape(gamma)
        joints = raw["joints"]
        return Geometry(
            *(raw[key] for key in ("centre", "axes", "size", "mass")),
            *(np.ascontiguousarray(joints[:, 3 * k : 3 * k + 3]) for k in range(4)),
            joints[:, 12],
            joints[:, 13],
            raw["contacts"],
            tuple(raw["joint_faults"]),
            tuple(raw["foot_faults"]),
            tuple(raw["overlaps"]),
        )

    def moved(self, gamma: np.ndarray | None = None) -> Piece:
        """The piece at design parameters (n, 8), its joints closed."""
        raw = self.kernel.shape(gamma)
        return self.piece.placed(raw["centre"], raw["axes"], raw["size"])

    def corners(self, gamma: np.ndarray | None = None) -> np.ndarray:
        """The corners (8 n, 3) [m] of its planks at design parameters (n, 8), plank by plank."""
        raw = self.kernel.shape(gamma)
        ways = (CORNERS * raw["size"][:, None]) @ np.swapaxes(raw["axes"], 1, 2)
        return (raw["centre"][:, None] + ways).reshape(-1, 3)

    def forces(self, case: int = 0) -> Forces:
        """Forces of a case at the last test."""
        raw = self.kernel.forces(case)
        tension, h_x, h_y, bending, twist_x, twist_n, pull, shear, line, twist = raw["joints"].T
        return Forces(
            raw["x"].reshape(-1, 6),
            raw["law"] == 1,
            raw["found"],
            raw["contacts"],
            raw["balance"],
            raw["unbalanced_load"],
            tension,
            np.stack([h_x, h_y], 1),
            bending,
            np.stack([twist_x, twist_n], 1),
            pull,
            shear,
            line,
            twist,
            self.piece.moments,
        )

    def nails(self) -> np.ndarray:
        """Fasteners (j,) in each joint, as the last test has them."""
        return self.kernel.nails()

    def loads(self) -> np.ndarray:
        """All that acts on the piece in each case, with its own weight (c, 3) [N]."""
        return self.cases.sum(axis=1) + float(self.geometry().mass.sum()) * np.array(self.piece.gravity)


def falling_cases(piece: Piece) -> set[int]:
    """The cases that a piece falls or slides in."""
    return {case for case, _ in Furniture(piece).test(wanted=UNSTABLE).found.falls}


def sliding_cases(piece: Piece, found: FlawNumbers) -> list[int]:
    """Of the cases that a piece in one part falls in those in which it slides: on a rough floor it would hold."""
    if len(parts_of(piece)) > 1 or not found.falls:
        return []
    rough = replace(piece, planes=tuple(replace(plane, mu=ROUGH) for plane in piece.planes))
    tips = falling_cases(rough)
    return [case for case in dict.fromkeys(case for case, _ in found.falls) if case not in tips]


def enough_mass(piece: Piece) -> float:
    """How much more mass [kg], spread like what is there, holds a piece that slides and nothing else; else inf."""
    furniture = Furniture(piece)
    found = furniture.test(wanted=UNSTABLE).found
    sliding = sliding_cases(piece, found)
    if not sliding or len(sliding) < len({case for case, _ in found.falls}):
        return np.inf
    return mass_needed(piece, furniture.loads()[sliding], falling_cases)
