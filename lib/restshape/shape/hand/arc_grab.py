"""What the hand holds of an arc: a point of it, through which the arc then goes; its ends stay."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.shape.hand.both_halves import twice
from restshape.shape.hand.gesture import bend
from restshape.shape.hand.shape_grab import Grab
from restshape.shape.hand.space_grab import Draggable
from restshape.shape.outline import Outline
from restshape.shape.topology_edits import as_arc, bulge_of, nearest
from restshape.shape.validity import problem, too_far


@dataclass(slots=True, kw_only=True)
class ArcGrab(Grab):
    """What the hand holds, as of `Grab`; the gesture is not linear in its way.

    Args:
        place: the point of the arc that it holds, at the press [m].
    """

    place: tuple[float, float]

    def taken(self, session: Draggable, c: tuple[float, float]) -> Outline | str:
        """The shape when the hand has gone a way c [m], or why it cannot be."""
        outline, scene = session.outline, session.scene
        if (far := too_far(outline, c)) is not None:
            return far
        through = np.array(self.place) + c
        try:
            bulge = bulge_of(outline, outline.entity(self.name).edges[0], through)
            wanted = twice(outline, scene, self.name, partial(bent, bulge=bulge))
        except UserError as error:
            return error.what
        return problem(wanted) or wanted


def is_arc(outline: Outline, name: str) -> bool:
    """Whether a name is that of one edge, an arc."""
    entity = outline.entity(name)
    return entity.vertices == entity.loops == () and [outline.edges[e].kind for e in entity.edges] == ["arc"]


def grab_arc(outline: Outline, scene: Scene, name: str, at: tuple[float, float] | None) -> ArcGrab:
    """The hand takes the point of an arc that is nearest to a place [m]; None: its middle.

    Raises:
        UserError: it is the fold of its panel.
    """
    twice(outline, scene, name, lambda same, _, __: same)
    entity = outline.entity(name)
    edge, s = (entity.edges[0], 0.5) if at is None else nearest(outline, entity, np.array(at))
    x, y = outline.point(edge, s)[0].tolist()
    origin = (x, y) if at is None else at
    return ArcGrab(bend(outline), origin, origin, (outline, scene), name=name, place=(x, y))


def bent(outline: Outline, on: str, image: bool, bulge: float) -> Outline:
    """An outline with an edge as an arc; the image of one bends the other way."""
    return as_arc(outline, outline.entity(on).edges[0], -bulge if image else bulge)
