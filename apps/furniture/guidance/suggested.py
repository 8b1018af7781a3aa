"""A suggestion of any kind, and what a search for them found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.guidance import amounts
from restshape_apps.furniture.guidance.connecting import Connection
from restshape_apps.furniture.guidance.remedies import Remedy, Setting
from restshape_apps.furniture.guidance.support_planks import FLOOR, SupportPlank
from restshape_apps.furniture.shape.planks import Piece, joints_near


@dataclass(frozen=True)
class Suggestion:
    """A suggestion of any kind.

    Args:
        words: what it does where it is shown, with amounts.
        direction: (n, 8) change of the design parameters by a unit of t; None: it is another piece.
        t: where it is shown: how far its leading parameter, which `words` names first, is changed [m or rad].
        span: valid range of t around it.
        valid: the full test holds there; else `rest` shows what is still wrong.
        piece: with one more plank; None where planks move.
        unit: of t, "m" or "rad"; empty for a piece.
        name: which parameters it changes.
        beyond: the range may go on past what was looked at, at both ends.
        rest: what is still wrong where it is shown; empty where it is valid.
        doubt: what is doubtful where it is valid; empty where nothing is.
        settings: keys of the scene and their values, of what is no other drawing; empty elsewhere.
        costs: what it costs the shape of the piece, such as its symmetry; empty where nothing.
        free: ends of what it joins that nothing holds there, near a face.
        weights: weights that it takes along, where planks that carry them change their length.
    """

    words: str
    direction: np.ndarray | None
    t: float
    span: tuple[float, float]
    valid: bool
    piece: Piece | None = None
    unit: str = ""
    name: str = ""
    beyond: tuple[bool, bool] = (False, False)
    rest: str = ""
    doubt: str = ""
    settings: tuple[Setting, ...] = ()
    free: int = 0
    costs: str = ""
    weights: str = ""

    @classmethod
    def along(
        cls, piece: Piece, direction: np.ndarray, t: float, span: tuple[float, float], open_: bool, valid: bool
    ) -> Suggestion:
        """The suggestion along a direction (n, 8), t and its range in any unit; `open_`: the range may go on."""
        leading = amounts.parameters(piece, direction)[0]
        scale = abs(float(direction[leading]))
        words, name = amounts.in_words(piece, t * direction), amounts.named(piece, direction)
        span = span[0] * scale, span[1] * scale
        unit = amounts.unit_of(leading[1])
        return cls(words, direction / scale, t * scale, span, valid, None, unit, name, (False, open_))

    @classmethod
    def of(cls, one: Connection) -> Suggestion:
        """The suggestion that joins a part to the rest, or free ends to what they missed."""
        return cls(one.words, None, 1.0, (0.0, 1.0), one.flaws == 0, one.piece, name=one.name, free=one.free)

    @classmethod
    def by(cls, one: Remedy) -> Suggestion:
        """The suggestion of other fasteners or thicker planks."""
        return cls(one.words, None, 1.0, (0.0, 1.0), True, one.piece, name=one.name, settings=one.settings)

    @classmethod
    def supported(cls, piece: Piece, board: SupportPlank) -> Suggestion:
        """The suggestion of a support plank of a piece, with its mirror images."""
        first, other = ("the floor" if k == FLOOR else piece.planks[k].name for k in board.between)
        plank = board.plank
        long, wide = (amounts.amount(float(size), "m") for size in plank.size[:2])
        place = ", ".join(f"{1e3 * x:.0f}" for x in plank.centre)
        words = f"a plank of {long} by {wide} between {first} and {other}, its middle at ({place}) mm"
        words += f", its length {amounts.along(plank.axes[:, 0])}, its width {amounts.along(plank.axes[:, 1])}"
        if len({round(float(one.size[2]), 9) for one in piece.planks}) > 1:
            words += f", {amounts.amount(float(plank.size[2]), 'm')} thick"
        if len({one.wood for one in piece.planks}) > 1:
            words += f", of {plank.wood}"
        others = (one for k, one in enumerate(piece.planks) if k not in board.between)
        # Drawn there by hand it would be joined to them.
        if beside := [one.name for one in others if joints_near((one, plank), piece.reach)]:
            words += f", not joined to {' and '.join(beside)} beside it"
        if board.mirrored:
            words += f"; and its mirror image{'s' * (len(board.mirrored) > 1)} across "
            words += " and ".join("xy"[axis] for axis in board.mirrored)
        return cls(words, None, 1.0, (0.0, 1.0), board.result.valid, board.piece, name="a support plank")

    @property
    def kind(self) -> str:
        """What kind of change it leads with: a move, a turn, a length, or a plank."""
        return self.name.partition(": ")[2].partition(" ")[0] if self.direction is not None else self.name

    @property
    def whole(self) -> str:
        """What it does, which weights it takes along, and what it costs the shape."""
        return "; ".join(filter(None, (self.words, self.weights, self.costs)))

    @property
    def range_words(self) -> str:
        """Its range, for people: how far its leading parameter may be changed; empty for a piece."""
        if not self.unit:
            return ""
        low, high = amounts.ends(*self.span, self.unit)
        others = ", the others in proportion" if np.count_nonzero(self.direction) > 1 else ""
        what = "valid" if self.valid else "nothing more is wrong"
        return f"{what} from {low} to {high}{' or beyond' if self.beyond[1] else ''}{others}"

    @property
    def summary(self) -> str:
        """What it does, and its range."""
        doubt = f"holds, but {self.doubt}" if self.doubt else ""
        parts = (self.whole, self.range_words, f"still wrong: {self.rest}" if self.rest else "", doubt)
        return "; ".join(filter(None, parts))


@dataclass(frozen=True)
class SuggestionList:
    """What was found for an invalid piece: suggestions, combinations tried, full tests, and the time taken [s].

    `why` shows why there are none.
    """

    found: tuple[Suggestion, ...] = ()
    tried: int = 0
    tested: int = 0
    seconds: float = 0.0
    why: str = ""
