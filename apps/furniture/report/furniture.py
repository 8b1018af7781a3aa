"""Pictures of furniture in space: utilisation of joints, forces of feet, weights, suggestions, ranges."""

# More than 15 modules: what is drawn in space and what is written over it meet here.

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize, to_rgb
from matplotlib.figure import Figure
from restshape_apps.furniture.guidance.range_way import way_of
from restshape_apps.furniture.physics.foot_forces import foot_forces
from restshape_apps.furniture.physics.furniture import LOST, Forces, Furniture
from restshape_apps.furniture.physics.joint_compliance import utilisation_range
from restshape_apps.furniture.physics.joint_label import joint_label
from restshape_apps.furniture.report.labels import Labels
from restshape_apps.furniture.report.status_colour import DOUBT
from restshape_apps.furniture.shape.changed_planks import LEAST, changed_planks
from restshape_apps.furniture.shape.planks import Piece, Plank

from restshape.guidance.ranges import Ranges
from restshape.outputs.si_numbers import length_unit
from restshape.report.camera import Camera, Window
from restshape.report.space_axes import draw_box
from restshape.report.space_scene import GHOST, HALO, MARK, TOP, SpaceImage
from restshape.report.style import BODY, COLOURS, INK, REFUSED

AZIMUTH, ELEVATION, FAR = np.radians(-62.0), np.radians(18.0), 6.0
"""Where the camera is, and its distance in sizes of the piece."""
FACES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
"""Corners of a plank's six sides, as `Plank.corners` counts them."""
EDGE = 0.7
"""Width of the edges of planks [points]."""
FOOT, LOAD, MOVED = "#0072b2", INK, "#d55e00"
NAMES, NAMED_AT = "#444444", 0.22
"""Colour of the names of planks, and where on their lengths they are."""
OPACITY = 0.38
"""Of the colour over what a suggestion changes, which nothing hides."""
ROOM = (0.3, 0.14, 0.2, 0.2)
"""Left, right, below and above the box, in parts of its width in the picture: for numbers and arrows."""
ROUNDED = 1e-5
"""Part of the way that was looked at by which ends of a range may be rounded."""
ARROW, SHORTEST = 0.12, 0.3
"""The longest arrow of a force, in parts of the piece's size, and the shortest in parts of that."""
BELOW = 0.9
"""Part of the room under another plank that the arrow of a load on the one below has at most."""
WAY = 0.1
"""The shortest arrow of a way, in parts of the piece's size."""
SHAFT, RIM = 0.005, 0.0035
"""Radius of an arrow, and how much wider what is behind it in white is, in parts of the piece's size."""
JOINT, OVERLOADED = 0.011, 0.015
"""Radius of a joint, and of one that breaks, in parts of the piece's size."""
STEEPEST = 0.25
"""Part of its length that an arrow of a way is seen with at least where it is made longer."""
SPOT = 0.015
"""Half of the place that words leave free for the circle at what is under the hand, in parts of the piece's size."""
REDUNDANT = 8
"""Redundant joints at most that are marked in a picture, those with the largest utilisation first."""
UTILISATION, RANGE, FORCE, NAME, SIDE = range(5)
"""Ranks of words: where there is no room for all, those of higher rank give way."""
NUDGE = 8.0
"""How far numbers along a side are moved at most where something is drawn over them [points]."""


@dataclass(frozen=True)
class DesignDirectionView:
    """What is drawn of an edit along a direction.

    Args:
        direction: (n, 8) change of the design parameters by a unit of t.
        t: its end state is drawn there; 0 draws the piece as it is.
        ranges: where it is valid, shown as an annotation beside the plank that moves most; None: not shown.
        low, high: of t, as far as it was looked at.
        valid: the piece as it is is valid: its range is black, else red.
        at: the piece as it is is that of this t.
        piece: the end state, where it is another piece, with more planks.
        unit: factor and unit of t in numbers; None: of the way that the plank goes, or of the angle that it turns by.
        doubts: (k, 2) parts of the range where the piece holds in doubt only.
    """

    direction: np.ndarray
    t: float = 0.0
    ranges: Ranges | None = None
    low: float = 0.0
    high: float = 0.0
    valid: bool = True
    at: float = 0.0
    piece: Piece | None = None
    unit: tuple[float, str] | None = None
    doubts: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))

    def end(self, furniture: Furniture) -> Piece | None:
        """The end state that is shown; None: there is none."""
        return self.piece or (furniture.moved(self.t * self.direction) if self.t else None)


@dataclass
class PieceView:
    """The axes, camera and units of one picture.

    Args:
        axes: to draw in.
        camera: looks at the piece.
        size: of the piece [m].
        reach: of the drawn arrows, to be kept in sight (k, 2).
    """

    axes: Axes
    camera: Camera
    size: float
    reach: list[np.ndarray] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.labels = Labels(self.axes)
        self.image = SpaceImage(self.axes, self.camera, opacity=OPACITY)

    def at(self, places: np.ndarray) -> np.ndarray:
        """Where places (n, 3) or (3,) are in the picture."""
        flat = self.camera.project(np.atleast_2d(places))
        return flat if np.ndim(places) > 1 else flat[0]

    def planks(self, planks: Sequence[Plank], ghosts: bool = False) -> None:
        """Planks with their edges; or, as a translucent colour over all others, those that an edit changes."""
        places = np.concatenate([np.zeros((0, 3)), *(plank.corners() for plank in planks)])
        faces = np.concatenate([np.zeros((0, 4), dtype=int), *(FACES + 8 * k for k in range(len(planks)))])
        if ghosts:
            self.image.veil.surface(places, faces, MOVED, layer=GHOST)
        else:
            self.image.scene.surface(places, faces, BODY, edges=(INK, EDGE))

    def arrow(self, start: np.ndarray, end: np.ndarray, colour: str) -> None:
        """An arrow from a place to another one."""
        self.image.scene.arrow(start, end, colour, SHAFT * self.size)
        ends = self.at(np.array([start, end]))
        self.reach.append(ends)
        self.labels.spare(ends)

    def way(self, start: np.ndarray, end: np.ndarray, colour: str, before: bool) -> None:
        """An arrow of a way from a place to another one, long enough to be seen; it is made longer beyond its end, or
        before its start."""
        seen, least = float(np.linalg.norm(np.diff(self.at(np.array([start, end])), axis=0))), WAY * self.size
        if seen < least:
            # Nearly along the view it would become endless.
            along = (end - start) * (least / max(seen, STEEPEST * float(np.linalg.norm(end - start))))
            start, end = (end - along, end) if before else (start, start + along)
        past = 2.0 * RIM * self.size * (end - start) / np.linalg.norm(end - start)
        self.image.scene.arrow(start - past, end + past, "white", (SHAFT + RIM) * self.size, HALO)
        self.arrow(start, end, colour)

    def words(
        self, place: np.ndarray, text: str, colour: str, up: float, aside: float = 0.0, rank: int = 0, **look: Any
    ) -> None:
        """Words beside a place, so many points above and to the right of it, or further where others of lower rank
        are there."""
        box = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.6}
        word = self.axes.annotate(
            text,
            self.at(place),
            xytext=(aside, up),
            textcoords="offset points",
            ha="center" if not aside else "left" if aside > 0 else "right",
            va="bottom" if up > 0 else "top" if up < 0 else "center",
            color=colour,
            bbox=box,
            zorder=9,
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "lw": 0.5, "color": colour, "shrinkA": 0, "shrinkB": 0},
            **{"fontsize": 7, **look},
        )
        self.labels.add(word, rank=rank)


def utilisation_colours() -> tuple[Colormap, Normalize]:
    """Colours of the utilisation of strength from 0 to 1, and red beyond."""
    return colormaps[COLOURS].with_extremes(over=REFUSED), Normalize(0.0, 1.0)


def add_utilisation_bar(figure: Figure, axes: Axes | Sequence[Axes]) -> None:
    """Put the colour bar of joints beside axes."""
    cmap, norm = utilisation_colours()
    bar = figure.colorbar(ScalarMappable(norm, cmap), ax=axes, extend="max", shrink=0.75, aspect=26, pad=0.01)
    bar.set_label("utilisation of a joint's strength,\npull or shear [1]; red: it breaks", fontsize=8)
    bar.ax.tick_params(labelsize=7)


def draw_piece(
    axes: Axes,
    furniture: Furniture,
    title: str = "",
    direction_view: DesignDirectionView | None = None,
    case: int = 0,
    numbers: bool = True,
    box: tuple[np.ndarray, np.ndarray] | None = None,
    names: Collection[str] = (),
) -> None:
    """Draw a piece with its joints, feet and weights: as it is, or the end state of an edit, with forces found there.

    Args:
        axes: emptied and given equal scales.
        furniture: its model; it is tested here.
        title: over the picture.
        direction_view: an edit of which the end state is drawn, or a range shown.
        case: of the loads and forces of feet; joints have their largest utilisation under any case.
        numbers: forces of feet in newtons, and masses, are written beside their arrows, and utilisations of redundant
            joints beside these.
        box: corners [m] that hold all, such as those of several pictures side by side.
        names: of planks that are written at them.
    """
    end = direction_view.end(furniture) if direction_view else None
    piece = furniture.moved()
    low, high = box or bounds(piece, *([end] if end else []))
    camera = Camera.towards(0.5 * (low + high), AZIMUTH, ELEVATION, FAR * float(np.linalg.norm(high - low)))
    view = PieceView(axes, camera, float((high - low).max()))
    window = camera.window(low, high)
    factor, unit = length_unit(view.size)
    axes.set_axis_off()
    sides = draw_box(view.image.scene, axes, camera, low, high, factor, unit, _points(axes, window))
    view.planks((end or piece).planks)
    if end:
        view.planks([plank for plank, other in zip(end.planks, changed_planks(piece, end)) if other], ghosts=True)
    _draw_forces(view, Furniture(end, furniture.compliance) if end else furniture, case, numbers)
    if end:
        _draw_moves(view, piece, end, direction_view.direction)
    if direction_view and direction_view.ranges is not None:
        _draw_range(view, furniture, direction_view, direction_view.ranges)
    _draw_names(view, [plank for plank in piece.planks if plank.name in names])
    for number in sides:
        number.set_zorder(9)
        view.labels.add(number, NUDGE, SIDE)
    _frame(view, window)
    if title:
        axes.set_title(title, fontsize=8.5, loc="left")


def bounds(*pieces: Piece) -> tuple[np.ndarray, np.ndarray]:
    """Two corners (3,) of a box around pieces [m], with some room, down to the floor."""
    corners = np.concatenate([plank.corners() for piece in pieces for plank in piece.planks])
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = 0.04 * float((high - low).max())
    low, high = low - room, high + room
    low[2] = min(0.0, float(corners[:, 2].min()))
    return low, high


def slenderness(low: np.ndarray, high: np.ndarray) -> float:
    """Height over width of a picture of what lies in a box (3,) to (3,), with room for its numbers and arrows."""
    camera = Camera.towards(0.5 * (low + high), AZIMUTH, ELEVATION, FAR * float(np.linalg.norm(high - low)))
    left, right, bottom, top = camera.window(low, high)
    wide = max(right - left, 0.6 * (top - bottom))
    return (top - bottom + (ROOM[2] + 0.09) * wide) / (right - left + (ROOM[0] + ROOM[1]) * wide)


def _points(axes: Axes, window: Window) -> float:
    """How many points a metre has in the picture, about: it is not laid out yet."""
    left, right, bottom, top = window
    wide = max(right - left, 0.6 * (top - bottom))
    return 72.0 / axes.figure.dpi * axes.bbox.width / (right - left + (ROOM[0] + ROOM[1]) * wide)


def _frame(view: PieceView, window: Window) -> None:
    """Give the axes limits that hold the box with its numbers, and all arrows."""
    left, right, bottom, top = window
    wide = max(right - left, 0.6 * (top - bottom))
    places = np.concatenate([[[left, bottom], [right, top]], *view.reach])
    (low_x, low_y), (high_x, high_y) = places.min(axis=0), places.max(axis=0)
    room = [part * wide for part in ROOM]
    view.axes.set_xlim(min(left - room[0], low_x - 0.05 * wide), max(right + room[1], high_x + 0.05 * wide))
    view.axes.set_ylim(min(bottom - room[2], low_y - 0.09 * wide), max(top + 0.03 * wide, high_y + 0.09 * wide))
    view.axes.set_aspect("equal")


def _draw_forces(view: PieceView, furniture: Furniture, case: int, numbers: bool) -> None:
    """Test a piece, and draw its joints, feet and loads; where a joint is lost, there are no forces but loads."""
    if not furniture.test().flaws & LOST:
        _draw_joints(view, furniture, numbers)
        _draw_feet(view, furniture, furniture.forces(case), numbers)
    _draw_loads(view, furniture, case, numbers)


def _draw_names(view: PieceView, planks: Sequence[Plank]) -> None:
    for plank in planks:
        # Beside the middle, where loads often are.
        place = plank.centre + NAMED_AT * plank.size[0] * plank.axes[:, 0]
        view.words(place, plank.name, NAMES, 0.0, 0.0, NAME, style="italic", fontsize=6.5)


def _draw_joints(view: PieceView, furniture: Furniture, numbers: bool) -> None:
    """Joints in the colours of their largest utilisation under any load case, as in the constraint status."""
    geometry, every = furniture.geometry(), [furniture.forces(case) for case in range(len(furniture.cases))]
    if not len(geometry.p):
        return
    cmap, norm = utilisation_colours()
    utilisation = np.max([one.utilisation for one in every], axis=0)
    moments = np.max([one.moment_utilisation for one in every], axis=0)
    doubt = (utilisation <= 1.0) & (moments > 1.0)
    half = 0.5 * geometry.length[:, None] * geometry.y
    joints = np.stack([geometry.p - half, geometry.p + half], axis=1)
    colours = np.where(doubt[:, None], to_rgb(DOUBT), cmap(norm(utilisation))[:, :3])
    for some, radius, layer in (
        ((utilisation <= 1.0) & ~doubt, JOINT, MARK),
        ((utilisation > 1.0) | doubt, OVERLOADED, TOP),
    ):
        view.image.scene.tubes(joints[some], "white", (radius + RIM) * view.size, HALO)
        view.image.scene.tubes(joints[some], colours[some], radius * view.size, layer)
    for ends in joints:
        view.labels.spare(view.at(ends))
    for k in np.flatnonzero((utilisation > 1.0) | doubt):
        # Level with its left end.
        left = joints[k][int(np.argmin(view.at(joints[k])[:, 0]))]
        most, colour = (moments[k], DOUBT) if doubt[k] else (utilisation[k], REFUSED)
        view.words(left, joint_label(float(most)), colour, 0.0, -4.0, UTILISATION)
    if numbers:
        _mark_redundant(view, furniture, joints)


def _mark_redundant(view: PieceView, furniture: Furniture, joints: np.ndarray) -> None:
    """The utilisation of redundant joints over the ratios of compliance, at the right ends of the joints (j, 2, 3)."""
    known = utilisation_range(furniture.moved(), furniture.compliance)
    for k in known.largest(REDUNDANT) if known else ():
        right = joints[k][int(np.argmax(view.at(joints[k])[:, 0]))]
        view.words(right, redundant_label(known.low[k], known.high[k]), NAMES, 0.0, 4.0, NAME, fontsize=6.5)


def redundant_label(low: float, high: float) -> str:
    """The least and the largest utilisation of a joint over the ratios of compliance."""
    least, most = (joint_label(one) if one > 1.0 else f"{one:.2f}" for one in (low, high))
    return f"{least}\N{EN DASH}{most}"


def marks_redundant(panels: Sequence[Axes]) -> bool:
    """Whether any of these pictures has a range of the utilisation of a redundant joint."""
    return any("\N{EN DASH}" in text.get_text() for axes in panels for text in axes.texts)


def _draw_feet(view: PieceView, furniture: Furniture, forces: Forces, numbers: bool) -> None:
    places, whole = foot_forces(furniture.geometry(), forces)
    largest = max(float(np.linalg.norm(whole, axis=1).max(initial=0.0)), 1e-300)
    for at, force in zip(places, whole):
        size = float(np.linalg.norm(force))
        tail = at - max(ARROW * size / largest, 0.3 * ARROW) * view.size * force / size
        view.arrow(tail, at, FOOT)
        if numbers:
            view.words(0.4 * tail + 0.6 * at, f"{size:.0f} N", FOOT, 0.0, 5.0, FORCE)


def _draw_loads(view: PieceView, furniture: Furniture, case: int, numbers: bool) -> None:
    piece, geometry = furniture.piece, furniture.geometry()
    loads = (*piece.weights, *piece.pushes)
    acting = [(load, force) for load, force in zip(loads, furniture.cases[case]) if np.any(force)]
    largest = max((float(np.linalg.norm(force)) for _, force in acting), default=1.0)
    g = float(np.linalg.norm(piece.gravity))
    for load, force in acting:
        k = load.plank
        at = geometry.centre[k] + geometry.axes[k] @ (np.array(load.place) * geometry.size[k])
        size = float(np.linalg.norm(force))
        length = max(ARROW * size / largest, SHORTEST * ARROW) * view.size
        others = [plank for i, plank in enumerate(piece.planks) if i != k]
        room = BELOW * _free_way(others, at, -force / size)
        # Through what lies above, it would seem to be a load of that, and so would words there.
        tail = at - min(length, max(room, 0.5 * SHORTEST * ARROW * view.size)) * force / size
        view.arrow(tail, at, LOAD)
        # A push straight down is a force, whatever mass would weigh as much.
        weight = g > 0.0 and load in piece.weights
        if not weight:
            # One across the view has next to no arrow.
            view.axes.plot(*view.at(at)[None].T, "o", ms=3.0, color=LOAD, zorder=8)
        if numbers:
            text = f"{size / g:.3g} kg" if weight else vector_words(force)
            place, up, aside = (0.5 * (tail + at), 0.0, 5.0) if weight and np.isfinite(room) else (tail, 2.0, 0.0)
            view.words(place, text, LOAD, up, aside, FORCE)


def _free_way(planks: Sequence[Plank], start: np.ndarray, along: np.ndarray) -> float:
    """How far it is from a place (3,) along a direction (3,) to the first of some planks; infinite if there is none."""
    nearest = np.inf
    for plank in planks:
        place, way = (start - plank.centre) @ plank.axes, along @ plank.axes
        way = np.where(np.abs(way) < 1e-12, 1e-12, way)
        ends = np.sort(np.stack([(sign * plank.size / 2.0 - place) / way for sign in (-1.0, 1.0)]), axis=0)
        first, last = float(ends[0].max()), float(ends[1].min())
        if first <= last and last > 0.0:
            nearest = min(nearest, max(first, 0.0))
    return nearest


def vector_words(force: np.ndarray) -> str:
    """A force [N] as people read it: how much along which axis, or its three components."""
    size, k = float(np.linalg.norm(force)), int(np.argmax(np.abs(force)))
    if abs(force[k]) > 0.9999 * size:
        text = f"{size:.3g} N along {'+' if force[k] > 0.0 else '-'}{'xyz'[k]}"
    else:
        text = f"({', '.join(f'{round(float(f), 1) + 0.0:g}' for f in force)}) N"
    return text.replace("-", "\N{MINUS SIGN}")


def in_one_view(panels: Sequence[Axes]) -> None:
    """Give pictures side by side the same limits, which hold what each of them shows."""
    across, up = ([limits(axes) for axes in panels] for limits in (Axes.get_xlim, Axes.get_ylim))
    for axes in panels:
        axes.set_xlim(min(low for low, _ in across), max(high for _, high in across))
        axes.set_ylim(min(low for low, _ in up), max(high for _, high in up))


def _draw_moves(view: PieceView, piece: Piece, end: Piece, direction: np.ndarray) -> None:
    """Arrows on the planks that an edit is of, at what of them goes furthest; a plank that grows has two."""
    edited = np.flatnonzero(np.abs(direction).max(axis=1))
    if not len(edited):
        # Another piece: what of it goes furthest.
        far = [float(np.linalg.norm(b.centre - a.centre)) for a, b in zip(piece.planks, end.planks)]
        edited = [int(np.argmax(far))]
    for k in edited:
        before, after = piece.planks[k], end.planks[k]
        starts, ends = (np.array([plank.end(side) for side in range(4)]) for plank in (before, after))
        far = np.linalg.norm(ends - starts, axis=1)
        side = int(np.argmax(far))
        apart = float(np.dot(ends[side] - starts[side], ends[side ^ 1] - starts[side ^ 1])) < 0.0
        shrinks = float(np.dot(ends[side] - starts[side], starts[side] - before.centre)) < 0.0
        for one in (side, side ^ 1) if apart and not direction[k, :6].any() else (side,):
            if far[one] > LEAST * view.size:
                view.way(starts[one], ends[one], MOVED, shrinks)


def _draw_range(view: PieceView, furniture: Furniture, direction_view: DesignDirectionView, ranges: Ranges) -> None:
    """The way of the plank that moves most, with the part of it that is valid and its ends, in degrees of a turn."""
    at, speed = way_of(furniture, direction_view.direction)
    furniture.test()
    turning = float(np.abs(direction_view.direction[:, 3:6]).max())
    alone = turning > 0.0 and not np.any(np.delete(direction_view.direction, (3, 4, 5), axis=1))
    usual = (np.degrees(turning), "°") if alone else (1e3 * float(np.linalg.norm(speed)), " mm")
    scale, unit = direction_view.unit or usual
    colour = INK if direction_view.valid else REFUSED
    at = at - direction_view.at * speed
    way = view.at(at + np.array([[direction_view.low], [direction_view.high]]) * speed)
    view.axes.plot(*way.T, color=colour, lw=0.8, ls=(0, (3, 3)), zorder=7, alpha=0.7)
    across = np.array([way[1, 1] - way[0, 1], way[0, 0] - way[1, 0]])
    across *= 0.018 * view.size / max(float(np.linalg.norm(across)), 1e-300)
    for left, right in ranges.intervals:
        line = view.at(at + np.array([[left], [right]]) * speed)
        view.axes.plot(*line.T, color=colour, lw=3.2, solid_capstyle="butt", zorder=8)
        for t, place in zip((left, right), line):
            is_open = min(abs(t - direction_view.low), abs(t - direction_view.high)) < ROUNDED * (
                direction_view.high - direction_view.low
            )
            view.axes.plot(*np.array([place - across, place + across]).T, color=colour, lw=1.6, zorder=8)
            text = f"{'beyond ' if is_open else ''}{t * scale:+.0f}{unit}".replace("-", "\N{MINUS SIGN}")
            view.words(at + t * speed, text, colour, 9.0 if t == right else -9.0, rank=RANGE)
    for left, right in direction_view.doubts:
        line = view.at(at + np.array([[left], [right]]) * speed)
        view.axes.plot(*line.T, color=DOUBT, lw=3.2, solid_capstyle="butt", zorder=8.5)
    here = view.at(at + direction_view.at * speed)
    view.axes.plot(*here[None].T, "o", ms=5, mfc="white", mec=colour, mew=1.5, zorder=9)
    view.labels.spare(np.array([here - SPOT * view.size, here + SPOT * view.size]))
    view.reach.append(way)
