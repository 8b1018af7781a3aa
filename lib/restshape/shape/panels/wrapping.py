"""Panels that begin wrapped on a cylinder about the axis of a body, with all lengths kept."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.bodies import POINTS, bodies_of
from restshape.scene.model import Scene
from restshape.scene.panels import Panel
from restshape.scene.space_values import number
from restshape.shape.placement import rotation

CLEARANCE = 0.01
"""Distance [m] between a body and a panel that is wrapped on it."""


@dataclass(frozen=True)
class Wrapping:
    """A cylinder that a flat panel is wrapped on: its y runs along the axis, its x around it from the front.

    The front is towards -y in space; what is right in the pattern is right to who looks at it from there.

    Args:
        centre: (3,) [m] on the axis, where y is 0.
        axes: (3, 3) rows: along the axis; from it to the front; from it to the right.
        radius: of the cylinder [m].
    """

    centre: Reals
    axes: Reals
    radius: float

    def places(self, own: Reals) -> Reals:
        """Places (n, 3) [m] of a panel's own coordinates (n, 2) [m]."""
        along, front, right = self.axes
        angle = own[:, :1] / self.radius
        return np.asarray(
            self.centre + own[:, 1:] * along + self.radius * (np.cos(angle) * front + np.sin(angle) * right)
        )

    def directions(self, own: Reals, d: Reals) -> Reals:
        """Derivatives (n, 3) of the places along directions d (n, 2) at own coordinates (n, 2) [m]."""
        along, front, right = self.axes
        angle = own[:, :1] / self.radius
        return np.asarray(d[:, 1:] * along + d[:, :1] * (np.cos(angle) * right - np.sin(angle) * front))


def wrapping_of(scene: Scene, name: str, panel: Panel) -> Wrapping | None:
    """The cylinder that a panel is wrapped on; None of one that begins flat.

    Raises:
        UserError: its body is not there, or has no radius.
    """
    if panel.around is None:
        return None
    bodies, where = bodies_of(scene), f"panels.{name}.around"
    if panel.around not in bodies:
        known = ", ".join(bodies) or "there is none"
        raise UserError(f"there is no body {panel.around!r} to wrap the panel on", where, f"bodies: {known}")
    body = bodies[panel.around].evaluated(scene.parameters)
    form = {key: np.array(getattr(body.form, key), dtype=float) for key in _numbers(body.kind)}
    centre = np.mean([form[key] for key in POINTS[body.kind]], axis=0)
    if "about" in panel.model_fields_set:
        centre = np.array([number(value, scene.parameters) for value in panel.about])
    along = np.array([0.0, 0.0, 1.0])
    way = form["end"] - form["start"] if "start" in form else np.zeros(3)
    # A capsule whose ends are one place is a ball.
    if length := np.linalg.norm(way):
        along = way / length * (-1.0 if way[2] < 0.0 else 1.0)
    radius = panel.radius
    if radius is None:
        if not {"radius", "half"} & form.keys():
            raise UserError(f"the body {panel.around!r} has no radius", f"panels.{name}", 'add radius = "0.2 m"')
        radius = CLEARANCE + (_reach(form, centre, along) if "half" in form else float(form["radius"]))
    return Wrapping(centre, _axes(along), radius)


def _numbers(kind: str) -> tuple[str, ...]:
    sizes = {"sphere": ("radius",), "capsule": ("radius",), "cylinder": ("radius",), "box": ("half", "rotate")}
    return *POINTS[kind], *sizes.get(kind, ())


def _reach(box: Mapping[str, Reals], centre: Reals, along: Reals) -> float:
    """The largest distance [m] of the corners of a box from an axis through a centre (3,) along a unit vector (3,)."""
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    about_x, about_y, about_z = box["rotate"].tolist()
    away = box["center"] + (signs * box["half"]) @ rotation((about_x, about_y, about_z)).T - centre
    return float(np.linalg.norm(np.cross(away, along), axis=1).max())


def _axes(along: Reals) -> Reals:
    """Rows (3, 3) of `Wrapping`; an axis along y has its front below."""
    front = np.array([0.0, -1.0, 0.0])
    front = front - front @ along * along
    if np.linalg.norm(front) < 1e-6:
        front = np.array([0.0, 0.0, -1.0])
    front /= np.linalg.norm(front)
    return np.array([along, front, np.cross(along, front)])
