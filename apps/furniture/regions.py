"""What pictures of guidance show: rays through force space, valid regions of two parameters, ranges of a drag."""

from collections.abc import Callable

import numpy as np
from restshape_apps.furniture.guidance.force_space import contact_space, durability_space, stability_space
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNBALANCED, UNSTABLE, Furniture
from restshape_apps.furniture.pieces import table
from restshape_apps.furniture.report.force_space import Ray, Region
from restshape_apps.furniture.report.furniture import DesignDirectionView
from restshape_apps.furniture.shape.design_modes import DesignModes

from restshape.errors import UserError
from restshape.guidance.force_space import LONGEST
from restshape.guidance.ranges import valid_ranges

STEPS = 121
SHOWN = 4
"""Rays in colour."""


def modes_of(furniture: Furniture) -> DesignModes:
    """The valid design modes of a model."""
    return DesignModes.of(furniture.piece, furniture.kernel.freedoms())


def mode(modes: DesignModes, words: str) -> int:
    """The number of a mode by what it does.

    Raises:
        UserError: there is none.
    """
    names = list(modes.names(np.arange(len(modes))))
    if words not in names:
        raise UserError(f"there is no design mode {words!r}", modes.piece.name, f"choose from {', '.join(names)}")
    return names.index(words)


def slid(furniture: Furniture, words: str, low: float, high: float) -> DesignDirectionView:
    """A drag of one mode, with the range that is valid."""
    valid = furniture.test().valid
    modes = modes_of(furniture)
    direction = modes.direction(np.array([mode(modes, words)]), np.array([1.0]))
    ranges = valid_ranges(furniture.kernel, direction, low, high, samples=97)
    furniture.test()
    return DesignDirectionView(direction, 0.0, ranges, low, high, valid)


def _ranged(kilograms: float, words: str, low: float, high: float) -> tuple[Furniture, DesignDirectionView]:
    furniture = Furniture(table(kilograms=kilograms))
    return furniture, slid(furniture, words, low, high)


RANGES: dict[str, Callable[[], tuple[Furniture, DesignDirectionView]]] = {
    "top: move z, 30 kg": lambda: _ranged(30.0, "top: move z", -0.5, 0.3),
    "top: move z, 50 kg": lambda: _ranged(50.0, "top: move z", -0.5, 0.3),
}
"""Drags whose range is shown, by their words."""


def joint_rays(
    furniture: Furniture, joints: tuple[int, int] | None = None
) -> tuple[list[Ray], list[np.ndarray], tuple[str, str]]:
    """Rays of suggestions, linearised ways (k, 2) of single modes, and names of the moments of two joints.

    Args:
        furniture: the tested model of a piece with weak joints.
        joints: their numbers; default: those that are used most.

    Raises:
        UserError: there are no such joints, or no suggestions.
    """
    count = len(furniture.piece.joints)
    utilisation = furniture.forces().pull_utilisation
    a, b = joints or tuple(np.sort(np.argsort(-utilisation)[:2]))
    if not (0 <= a < count and 0 <= b < count and a != b):
        raise UserError(f"there are no two joints {a} and {b}", "--joints", f"choose from 0 to {count - 1}")
    found = suggest(furniture)
    furniture.test()
    space = durability_space(furniture, found.modes)
    pair = np.array([a, b])
    h, K = space.h[pair], space.K[:, pair]
    if not found.found:
        raise UserError("this piece has no suggestions", furniture.piece.name, "choose one whose joints break")
    rays = []
    for one in found.found[:SHOWN]:
        t = np.linspace(0.0, min(1.1 * one.span[1], LONGEST), STEPS)
        slope = np.array(one.parts) @ K[list(one.modes)]
        true, valid = _along(furniture, one.direction, t, lambda: _moments(furniture)[pair])
        rays.append(Ray(" and ".join(one.words), h + t[:, None] * slope, true, valid))
    furniture.test()
    ways = np.linspace(-LONGEST, LONGEST, 3)[:, None, None]
    others = [h + way for way in np.moveaxis(ways * K[None], 1, 0) if np.abs(way).max() > 1e-3]
    names = (
        f"moment of joint {joint}, {_joint(furniture, joint)}\n[1 = what its nails bear]" for joint in (int(a), int(b))
    )
    return rays, others, tuple(names)


def tipping_rays(furniture: Furniture) -> tuple[list[Ray], tuple[str, str]]:
    """Rays of suggestions that make a piece stand, and names of the reactions at the two sides of its feet."""
    found = suggest(furniture)
    furniture.test()
    space, side = contact_space(furniture, found.modes), furniture.geometry().contacts[:, 0] > 0.0
    scale = _pressed(furniture).sum()
    halves = np.stack([~side, side], axis=1).astype(float) * scale
    h, K = space.h @ halves, space.K @ halves
    rays = []
    for one in found.found[:SHOWN]:
        t = np.linspace(0.0, min(1.1 * one.span[1], LONGEST), STEPS)
        slope = np.array(one.parts) @ K[list(one.modes)]
        true, valid = _along(furniture, one.direction, t, lambda: _pressed(furniture) @ (halves / scale))
        rays.append(Ray(" and ".join(one.words), h + t[:, None] * slope, true, valid))
    furniture.test()
    return rays, ("force at the left edge of the foot [N]", "force at its right edge [N]")


def _along(
    furniture: Furniture, direction: np.ndarray, t: np.ndarray, forces: Callable[[], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Two forces (k, 2) that the full model finds along a direction, and where it is valid (k,)."""
    true, valid = np.full((len(t), 2), np.nan), np.zeros(len(t), dtype=bool)
    for k, step in enumerate(t):
        result = furniture.test(step * direction)
        valid[k] = result.valid
        if not result.flaws & (LOST | UNBALANCED):
            true[k] = forces()
    return true, valid


def _moments(furniture: Furniture) -> np.ndarray:
    """Moments (j,) of joints in parts of what their nails bear beside the pull, at the last test."""
    forces, nails = furniture.forces(), furniture.nails()
    bears = 0.5 * furniture.lever * (furniture.strength[:, 0] * nails - forces.tension)
    return forces.bending / bears


def _pressed(furniture: Furniture) -> np.ndarray:
    """Normal forces (c,) of contacts as springs both ways [N], at the last test."""
    normals = np.repeat([furniture.piece.planes[foot.plane].normal for foot in furniture.piece.feet], 4, axis=0)
    return np.einsum("ca,ca->c", furniture.forces().contacts, normals)


def _joint(furniture: Furniture, number: int) -> str:
    joint, planks = furniture.piece.joints[number], furniture.piece.planks
    return f"{planks[joint.i].name} on {planks[joint.j].name}"


def linearised_and_true(
    furniture: Furniture,
    words: tuple[str, str],
    x: tuple[float, float],
    y: tuple[float, float],
    points: int = 81,
) -> Region:
    """Where a piece is valid over two modes, by the full test and by linearised forces.

    Args:
        furniture: its tested model.
        words: the two modes.
        x, y: from and to of each, as modes count: in sizes of the piece, or radians. Two turns of one
            plank are parts of a rotation vector: it turns once, about an axis between theirs.
        points: along each.
    """
    modes = modes_of(furniture)
    pair = np.array([mode(modes, one) for one in words])
    few = DesignModes(furniture.piece, modes.freedoms[pair], modes.unit)
    spaces = [durability_space(furniture, few), stability_space(furniture, few)]
    steps = np.linspace(*x, points), np.linspace(*y, points)
    s, t = np.meshgrid(*steps)
    both = np.stack([s, t], axis=-1)
    inside = np.full(s.shape, np.inf)
    for space in spaces:
        forces = space.h + both @ space.K
        inside = np.minimum(inside, np.minimum(forces - space.low, space.high - forces).min(axis=-1))
    kind = np.zeros(s.shape, dtype=int)
    for k, l in np.ndindex(s.shape):
        flaws = furniture.test(modes.direction(pair, both[k, l])).flaws
        lost = flaws & (LOST | OVERLAPPING | UNBALANCED)
        kind[k, l] = 3 if lost else 2 if flaws & UNSTABLE else 1 if flaws else 0
    furniture.test()
    axes, names = [], []
    for number, values in zip(pair, steps):
        turn = 3 <= modes.freedoms[number][1] < 6
        axes.append(np.degrees(values) if turn else 1e3 * modes.unit * values)
        names.append(f"{modes.names(np.array([number]))[0]} [{'°' if turn else 'mm'}]")
    return Region(axes[0], axes[1], names[0], names[1], kind, inside)
