"""What an application says of a frame at the hand: drawings, choices, charts and tones, which any page can show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from restshape.arrays import Indices, Reals

Meaning = Literal["inside", "outside", "force", "support", "load", "goal", "node", "guide", "limit", "uncertain"]
"""Which colour of the page's style a mark has: inside or outside a valid range, a nodal line, a violated limit, ..."""
NOWHERE: Reals = np.empty((0, 2))


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines in the plane or in space.

    Args:
        name: what they are, for the legend; marks of one name replace each other from frame to frame.
        points: (m, d) [m] in the shape as it lies in the frame; none where `nodes` says where they are.
        starts: index of the first point of each line; one that is alone in its line is drawn as a dot.
        meaning: which colour they have.
        moved: (m, d) [m] displacements of the points; None: those of the shape there, and none of goals.
        words: of each line, to be read beside it; empty: of none.
        mode: number of the mode that is drawn where they are shown; 0: whatever is drawn.
        nodes: (m, k) of the mesh, in whose middle each point is, at rest and deformed: see `at_nodes`; None: of none.
    """

    name: str
    points: Reals
    starts: Sequence[int] = (0,)
    meaning: Meaning = "guide"
    moved: Reals | None = None
    words: Sequence[str] = ()
    mode: int = 0
    nodes: Indices | None = None

    def gone(self, moved: Reals | None) -> Lines:
        """The same lines with other displacements."""
        return replace(self, moved=moved)

    def at_nodes(self, nodes: Indices) -> Lines:
        """The same lines at nodes (m, k) of the mesh: they travel once, and the page has them follow the shape."""
        return replace(self, points=NOWHERE, moved=None, nodes=nodes)


@dataclass(frozen=True, eq=False)
class Arrows:
    """Vectors at points, all drawn at one scale, whose longest is as long as a part of the shape.

    Args:
        name: what they are, for the legend.
        points: (m, d) [m] where they are; none where `nodes` says that.
        vectors: (m, d) in `unit`.
        unit: SI.
        meaning: which colour they have.
        words: of each arrow; empty: of none.
        moved: (m, d) [m] displacements of the points; None: those of the shape there, and none of goals.
        tips: of each arrow, whether it ends at its point, as one that pushes does; empty: all of them begin there.
        nodes: as of `Lines`.
    """

    name: str
    points: Reals
    vectors: Reals
    unit: str
    meaning: Meaning = "force"
    words: Sequence[str] = ()
    moved: Reals | None = None
    tips: Sequence[bool] = ()
    nodes: Indices | None = None

    def gone(self, moved: Reals | None) -> Arrows:
        """The same arrows with other displacements."""
        return replace(self, moved=moved)

    def at_nodes(self, nodes: Indices) -> Arrows:
        """The same arrows at nodes (m, k) of the mesh; as of `Lines`."""
        return replace(self, points=NOWHERE, moved=None, nodes=nodes)


@dataclass(frozen=True)
class Words:
    """A line of text.

    Args:
        text: plain English.
        at: (d,) [m] beside which it is; None: beside the hand, or among the notes where no hand is.
        meaning: which colour it has.
        moved: (d,) [m] displacement of that place; None: that of the shape there, and none of goals.
    """

    text: str
    at: Sequence[float] | None = None
    meaning: Meaning = "guide"
    moved: Sequence[float] | None = None


@dataclass(frozen=True)
class NodeValue:
    """The value of a quantity beside a node of the mesh: it travels once, and the page writes it in each frame.

    Args:
        name: of the quantity, whose value and estimated error frames have; unit: SI; node: of the mesh.
    """

    name: str
    unit: str
    node: int


@dataclass(frozen=True)
class Offer:
    """A change that can be clicked, and slid along where it has a range.

    Args:
        name: a few words.
        text: a line that explains it.
        events: of edit scripts, in order, that carry it out; each "do" and its keys.
        slide: event that goes along it: with a number between 0 and 1 in its key `slid`; None: there is none.
        slid: key of `slide` for the number.
        lines: what it would look like.
    """

    name: str
    text: str
    events: Sequence[Mapping[str, object]]
    slide: Mapping[str, object] | None = None
    slid: str = "to"
    lines: Sequence[Lines] = ()


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves over an axis, such as a resonance curve.

    Args:
        name: what it shows.
        x_label, y_label: names of the axes with their units.
        curves: by name, the x (m,) and y (m,) of each.
        at: x of vertical lines by name.
        logarithmic: the y axis is.
    """

    name: str
    x_label: str
    y_label: str
    curves: Mapping[str, tuple[Reals, Reals]]
    at: Mapping[str, float] = field(default_factory=dict)
    logarithmic: bool = False


@dataclass(frozen=True)
class Tone:
    """A sound of decaying partials, which the page plays when it has changed, and when the shape is struck.

    Args:
        frequencies: [Hz]; decays: rates [1/s] by which amplitudes fall; amplitudes: of each, the largest 1.
        name: of the tone, such as "C5 +3 cents".
        at: place [m] that is struck; None: it is not known.
        moved: displacement [m] of that place; None: as the shape that is drawn.
    """

    frequencies: Sequence[float]
    decays: Sequence[float]
    amplitudes: Sequence[float]
    name: str = ""
    at: Sequence[float] | None = None
    moved: Sequence[float] | None = None


Mark = Lines | Arrows | Words | NodeValue | Offer | Chart | Tone


def shown_with(marks: Sequence[Mark], mode: int) -> list[Mark]:
    """The marks that are shown where a mode is drawn, by its number."""
    return [one for one in marks if type(one) is not Lines or not one.mode or one.mode == mode]
