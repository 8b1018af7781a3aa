"""What all pictures of one recording have in common: extent, exaggeration, colours, units."""

from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba

from restshape.application import applications
from restshape.errors import UserError
from restshape.physics.elasticity.goal import Goal
from restshape.physics.elasticity.target_curves import goal_curve
from restshape.replay.recording import Recording
from restshape.report.outlines import border, lines, polygons
from restshape.report.style import BODY, COLOURS, GOAL, INK, MESH, length_unit, scaled_unit, si
from restshape.scene.physics import PictureField

SHARE = 0.08
UNNAMED = PictureField("", "")


@dataclass(frozen=True)
class Scenery:
    """Common to all frames drawn.

    Args:
        scale: exaggeration of the displacement.
        largest: displacement [m].
        extent: xmin, xmax, ymin, ymax of everything drawn [m].
        field: scalar field that gives the colour, or None.
        look: its label and unit.
        deforms: a displacement is recorded.
        top: value [field's unit] at the top of the colour bar; ``clipped`` if there are higher ones.
        bottom: value at its bottom.
        goals: curves (m, 2) [m] that the deformed shape should meet; drawn as they are.
    """

    scale: float
    largest: float
    extent: tuple[float, float, float, float]
    field: str | None
    bottom: float
    top: float
    clipped: bool
    goals: tuple[np.ndarray, ...] = ()
    look: PictureField = UNNAMED
    deforms: bool = True

    @property
    def unit(self) -> tuple[float, str]:
        """Factor and unit of lengths on the axes."""
        return length_unit(max(self.extent[1] - self.extent[0], self.extent[3] - self.extent[2]))

    @property
    def colour(self) -> tuple[float, str]:
        """Factor of the field's values and the label of the colour bar."""
        factor, shown = scaled_unit(max(abs(self.bottom), abs(self.top)), self.look.unit)
        return factor, f"{self.look.label} [{shown}]" if shown else self.look.label

    @property
    def deformation(self) -> str:
        """What the title says of the deformed shape; empty where there is no displacement in the recording."""
        if not self.deforms:
            return ""
        if not self.largest:
            return "no displacement"
        return f"deformation ×{self.scale:.3g}, largest displacement {si(self.largest, 'm')}"


class Drawing:
    """The artists of one panel, used again from frame to frame.

    Args:
        axes: where they are drawn.
        scenery: common to all panels.
    """

    def __init__(self, axes: Axes, scenery: Scenery) -> None:
        self.axes, self.scenery = axes, scenery
        factor, _ = scenery.unit
        colour, _ = scenery.colour
        self.body = PolyCollection([], edgecolors=to_rgba(MESH, 0.4), linewidths=0.25, facecolors=BODY)
        if scenery.field:
            self.body.set_cmap(colormaps[COLOURS].with_extremes(bad=BODY))
            self.body.set_clim(scenery.bottom * colour, scenery.top * colour)
        self.rest = LineCollection([], colors=INK, linewidths=0.7)
        axes.add_collection(self.body, autolim=False)
        axes.add_collection(self.rest, autolim=False)
        goals = [factor * goal for goal in scenery.goals]
        axes.add_collection(LineCollection(goals, colors=GOAL, linewidths=1.3), autolim=False)
        xmin, xmax, ymin, ymax = (value * factor for value in scenery.extent)
        axes.set(xlim=(xmin, xmax), ylim=(ymin, ymax), aspect="equal")

    def show(self, recording: Recording, i: int) -> None:
        """Puts frame i into the artists."""
        scenery = self.scenery
        X, cells = recording.mesh(i)
        factor, _ = scenery.unit
        x = factor * (X + scenery.scale * displacement(recording, i))
        self.body.set_verts(polygons(x, cells))
        self.rest.set_segments(factor * lines(X, border(cells)))
        if scenery.field:
            self.body.set_array(np.ma.masked_invalid(scenery.colour[0] * by_cell(recording, i, scenery.field)))


def scenery(recording: Recording, frames: np.ndarray, scale: float | None = None) -> Scenery:
    """What the pictures of these frames have in common.

    Args:
        recording: two-dimensional.
        frames: indices that are looked at.
        scale: exaggeration; default: the largest displacement becomes 8 % of the size, but 1 where there is a goal.

    Raises:
        UserError: the recording is not of a shape in the plane.
    """
    if recording.dimension != 2:
        raise UserError("pictures can be drawn of shapes in the plane only", str(recording.path), "open it in ParaView")
    field, look = _colour_field(recording)
    low, high, values, largest = [], [], [], 0.0
    for i in frames:
        X = recording.points(i)
        low.append(X.min(axis=0))
        high.append(X.max(axis=0))
        largest = max(largest, float(np.hypot(*displacement(recording, i).T).max(initial=0.0)))
        if field:
            values.append(by_cell(recording, i, field))
    size = float(np.max(np.max(high, axis=0) - np.min(low, axis=0)))
    goals = goals_of(recording)
    if scale is None and goals:
        scale = 1.0
    if scale is None:
        scale = float(f"{SHARE * size / largest:.2g}") if largest else 1.0
    for i in frames:
        x = recording.points(i) + scale * displacement(recording, i)
        low.append(x.min(axis=0))
        high.append(x.max(axis=0))
    low.extend(goal.min(axis=0) for goal in goals)
    high.extend(goal.max(axis=0) for goal in goals)
    margin = 0.02 * size
    (xmin, ymin), (xmax, ymax) = np.min(low, axis=0) - margin, np.max(high, axis=0) + margin
    extent = (float(xmin), float(xmax), float(ymin), float(ymax))
    known = any(np.isfinite(value).any() for value in values)
    return Scenery(
        scale,
        largest,
        extent,
        field if known else None,
        *_colour_range(values, look.from_zero),
        goals,
        look,
        "displacement" in recording.fields,
    )


def goals_of(recording: Recording) -> tuple[np.ndarray, ...]:
    """The goals (m, 2) [m] of the recorded scene; those that an edit has set later are not known."""
    scene = recording.header.get("scene_values")
    given = scene.get("goal", {}) if isinstance(scene, dict) else {}
    return tuple(goal_curve(Goal.model_validate(goal)) for goal in given.values())


def by_cell(recording: Recording, i: int, field: str) -> np.ndarray:
    """A scalar field of frame i, a value a cell (ne,): of one at nodes the mean of the corners."""
    values = recording.field(i, field)
    return values if recording.fields[field].where == "cell_data" else values[recording.mesh(i)[1][:, :3]].mean(axis=1)


def _colour_field(recording: Recording) -> tuple[str | None, PictureField]:
    """The field that gives the colour, and how it looks: the first that a physics names, else any of the cells."""
    scalars = {name: info.where for name, info in recording.fields.items() if not info.components}
    app = applications().get(recording.header.get("app"))
    for one in app.physics if app else ():
        for name, look in one.pictured.items():
            if name in scalars:
                return name, look
    first = next((name for name, where in scalars.items() if where == "cell_data"), None)
    return first, PictureField(first or "", "")


def _colour_range(values: list[np.ndarray], from_zero: bool) -> tuple[float, float, bool]:
    """Bottom, top, and whether some values lie above: a corner's singular stress must not darken all the rest."""
    finite = np.concatenate(values) if values else np.zeros(0)
    finite = finite[np.isfinite(finite)]
    if not len(finite) or finite.max() == finite.min() == 0:
        return 0.0, 1.0, False
    bottom, top = float(finite.min()), float(finite.max())
    if from_zero:
        bottom = min(0.0, bottom)
    usual = float(np.percentile(finite, 99.5))
    if from_zero and usual > 0 and top > 3 * usual:
        return bottom, usual, True
    return bottom, top if top > bottom else bottom + 1.0, False


def displacement(recording: Recording, i: int) -> np.ndarray:
    """Displacement (n, 2) of frame i [m]; zero where none is known."""
    if "displacement" not in recording.fields:
        return np.zeros_like(recording.points(i))
    return np.nan_to_num(recording.field(i, "displacement")[:, :2], posinf=0.0, neginf=0.0)
