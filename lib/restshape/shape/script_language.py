"""Edit scripts from short lines of text, such as "hole window by 0.8 0 in 160 frames, hand-like"."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from pydantic import ValidationError

from restshape.errors import UserError
from restshape.scene.edit_script import EVENTS, FORMAT, VERSION, Script
from restshape.scene.held_point import CLOTH
from restshape.scene.model import Scene
from restshape.scene.overrides import parse_override
from restshape.scene.plain_values import Table
from restshape.scene.units import quantity
from restshape.scene.validation_errors import plain, whole_lists
from restshape.shape.hand.handpath import cursor_path
from restshape.shape.hand.pin_drag import begin_space_grab
from restshape.shape.hand.pull import pull
from restshape.shape.outline import Outline
from restshape.shape.script_session import FRAME_TIME
from restshape.shape.session import EditSession

GRAMMAR = """\
[KIND] ENTITY by DX DY [DZ] in N frames[, straight | jerk | hand-like][, pause K]
                                                       KIND: vertex, edge, hole, region, group, body, support;
                                                       DZ: of bodies and of supports in space
cloth at X Y from X Y Z by DX DY DZ in N frames[, straight | jerk | hand-like][, pause K]
                                                       a point of the pattern, and where the hand begins in space
rotate ENTITY by ANGLE [about X Y] [in N frames]       scale ENTITY by FACTOR [about X Y] [in N frames]
pull CURVE [at X Y] by DX DY [pins PIN PIN ...] in N frames[, straight | jerk | hand-like][, pause K]
                                                       PIN: a vertex, or (X Y)
smooth CURVE by STRENGTH [pins PIN ...] [in N frames]  STRENGTH: between 0 and 1
arc EDGE to BULGE [in N frames]                        insert NAME on EDGE at S (0 < S < 1)
hole NAME at X Y radius R                              delete ENTITY
set KEY = VALUE [in N frames]                          idle N | undo | redo | analyse
lengths in m or with a unit (8 mm), angles with a unit (30 deg)"""

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
LENGTH = rf"{NUMBER}(?:\s*(?:mm|cm|dm|km|um|nm|µm|in|ft|m)\b)?"
ANGLE = rf"{NUMBER}(?:\s*(?:deg|rad|°))?"
NAME = r"[^\s,=]+"
FRAMES = r"(?:\s+in\s+(?P<frames>\d+)\s+frames?)?"
ABOUT = rf"(?:\s+about\s+(?P<ax>{LENGTH})\s+(?P<ay>{LENGTH}))?"
PIN = rf"\s+(?:\(\s*(?P<px>{LENGTH})\s+(?P<py>{LENGTH})\s*\)|(?P<vertex>(?!in\s)[^\s,=()]+))"
PINS = rf"(?:\s+pins(?P<pins>(?:{re.sub(r'P<[a-z]+>', ':', PIN)})+))?"
PLAIN = r"(?P<do>analyse|undo|redo)"
KINDS = r"(?:vertex|point|edge|hole|region|group|body|support)\s+"


@dataclass
class InterpretedLines:
    """A script in the making.

    Args:
        lines: of JSON, the header first.
        frames: so far, without the start.
        refused: (text, frames refused, why) of the lines that the session does not take whole.
    """

    lines: list[str]
    frames: int = 0
    refused: list[tuple[str, int, str]] = field(default_factory=list)

    def text(self) -> str:
        """The script as JSON Lines."""
        return "\n".join(self.lines) + "\n"


class LineInterpreter:
    """Turns lines of text into events, and carries them out so that the next line starts from where they lead.

    Args:
        scene: that the script is for.
        seed: of hand-like paths.
        outline: the shape, when it does not come from ``[shape]``.
    """

    grammar = GRAMMAR
    events = EVENTS

    def __init__(self, scene: Scene, seed: int = 0, outline: Outline | None = None) -> None:
        self._session = self._begin(scene, outline)
        self._seed = seed
        header = {"format": FORMAT, "version": VERSION, "scene": scene.path.name, "units": "m"}
        self.result = InterpretedLines([json.dumps(header)])

    def _begin(self, scene: Scene, outline: Outline | None) -> EditSession:
        """The session that carries events out."""
        return EditSession(scene, Script.empty(scene), outline=outline)

    def _rules(self) -> list[Rule]:
        """What lines of text may be, and what makes events of them."""
        return RULES

    def add(self, text: str) -> None:
        """Adds one line of text.

        Raises:
            UserError: it is not understood, or names what is not there.
        """
        found = ((make, pattern.fullmatch(text.strip())) for pattern, make in self._rules())
        make, match = next((pair for pair in found if pair[1]), (None, None))
        if make is None or match is None:
            raise UserError(
                f"{text.strip()!r} is not understood", "line of the script", f"write one of\n{self.grammar}"
            )
        wrong, why = 0, ""
        for event in make(self, match):
            for refused in self._perform(text, event):
                wrong, why = wrong + 1, why or refused
        if wrong:
            self.result.refused.append((text.strip(), wrong, why))

    def _perform(self, text: str, event: Table) -> list[str]:
        """Why frames of an event are refused; the event is written down in any case."""
        stamped = {"t": round(self.result.frames * FRAME_TIME, 6), **event}
        try:
            found = self.events[str(event["do"])].model_validate(stamped)
        except ValidationError as error:
            first = whole_lists(error.errors())[0]
            key = ".".join(str(part) for part in first["loc"])
            what, do = plain(first)
            raise UserError(f"{key}: {what}", text.strip(), do or f"write one of\n{self.grammar}") from error
        steps = list(self._session.steps(found))
        self.result.frames += len(steps)
        self.result.lines.append(json.dumps(stamped, allow_nan=False, default=str))
        return [step.refused for step in steps if step.refused is not None]

    def _place(self, name: str) -> tuple[float, ...]:
        """Where an entity is now [m]; in space of a body or a support in space."""
        outline, scene = self._session.outline, self._session.scene
        grabbed = begin_space_grab(outline, scene, name, None)
        return grabbed.origin if grabbed is not None else tuple(outline.centroid(outline.entity(name)).tolist())

    def _drag(self, match: re.Match[str]) -> list[Table]:
        count = 2 if match["dz"] is None else 3
        start = self._place(match["on"])[:count]
        if len(start) < count:
            what = f"{match['on']} is a part of the shape, which has no z"
            raise UserError(what, match.string, "leave the third length out")
        return self._moved({"do": "press", "on": match["on"], "at": list(start)}, start, match)

    def _cloth(self, match: re.Match[str]) -> list[Table]:
        at, start = (tuple(length(match[key]) for key in keys) for keys in (("x", "y"), ("fx", "fy", "fz")))
        return self._moved({"do": "press", "on": CLOTH, "at": list(at)}, start, match)

    def _pull(self, match: re.Match[str]) -> list[Table]:
        outline, pins = self._session.outline, _pins(match)
        at = None if match["x"] is None else (length(match["x"]), length(match["y"]))
        # Where the curve itself is, so that it does not jump to the cursor.
        x, y = (float(f"{value:.9g}") for value in pull(outline, match["on"], at, pins)[1])
        start = x, y
        hold = {"do": "pull", "on": match["on"], "at": list(start)}
        return self._moved(hold | ({} if pins is None else {"pins": pins}), start, match)

    def _moved(self, hold: Table, start: tuple[float, ...], match: re.Match[str]) -> list[Table]:
        """Taking hold, a drag and letting go."""
        frames = _frames(match)
        step = tuple(length(match[key]) for key in ("dx", "dy", "dz")[: len(start)])
        style, pause = _style(match["styles"] or "")
        if pause >= frames:
            raise UserError(
                f"a pause of {pause} frames does not fit into {frames}: it is part of them and one must move",
                match.string,
                f"say in {pause + max(frames, 2)} frames, or a shorter pause",
            )
        path = cursor_path(start, step, frames, style, pause, self._seed)
        self._seed += 1
        return [hold, {"do": "drag", "path": [list(p) for p in path]}, {"do": "release"}]

    def _smooth(self, match: re.Match[str]) -> list[Table]:
        pins = _pins(match)
        event = {"do": "smooth", "on": match["on"], "strength": float(match["strength"])}
        return [_turned(match, event | ({} if pins is None else {"pins": pins}))]

    def _rotate(self, match: re.Match[str]) -> list[Table]:
        return [_turned(match, {"do": "rotate", "on": match["on"], "by": quantity(match["by"], "angle")})]

    def _scale(self, match: re.Match[str]) -> list[Table]:
        return [_turned(match, {"do": "scale", "on": match["on"], "factor": float(match["factor"])})]

    def _arc(self, match: re.Match[str]) -> list[Table]:
        return [_turned(match, {"do": "arc", "on": match["on"], "bulge": float(match["bulge"])})]

    def _insert(self, match: re.Match[str]) -> list[Table]:
        return [{"do": "insert", "on": match["on"], "name": match["name"], "s": float(match["s"])}]

    def _hole(self, match: re.Match[str]) -> list[Table]:
        center = [length(match["x"]), length(match["y"])]
        return [{"do": "hole", "name": match["name"], "center": center, "radius": length(match["radius"])}]

    def _delete(self, match: re.Match[str]) -> list[Table]:
        return [{"do": "delete", "on": match["on"]}]

    def _set(self, match: re.Match[str]) -> list[Table]:
        _, value = parse_override(f"{match['key']}={match['value']}")
        frames = _frames(match)
        return [{"do": "set", "key": match["key"], "value": value} | ({"frames": frames} if frames > 1 else {})]

    def _idle(self, match: re.Match[str]) -> list[Table]:
        return [{"do": "idle", "frames": int(match["frames"])}]

    def _plain(self, match: re.Match[str]) -> list[Table]:
        return [{"do": match["do"]}]


def length(text: str) -> float:
    """A length in metres from text, a plain number being in metres."""
    try:
        return float(text)
    except ValueError:
        return quantity(text, "length")


def _turned(match: re.Match[str], event: Table) -> Table:
    """The event with centre and number of frames, where the text has them."""
    if match.groupdict().get("ax"):
        event["about"] = [length(match["ax"]), length(match["ay"])]
    return {**event, "frames": _frames(match)}


def _pins(match: re.Match[str]) -> list[str | tuple[float, float]] | None:
    """The pins of a text: names of vertices, and places [m]; None without any."""
    if not match["pins"]:
        return None
    found = re.finditer(PIN, match["pins"])
    return [(length(pin["px"]), length(pin["py"])) if pin["px"] else pin["vertex"] for pin in found]


def _frames(match: re.Match[str]) -> int:
    """How many frames the text asks for, one if it does not say.

    Raises:
        UserError: none.
    """
    frames = int(match["frames"] or 1)
    if frames < 1:
        raise UserError("an edit takes one frame at least", match.string, "say in 1 frame, or more")
    return frames


def _style(text: str) -> tuple[str, int]:
    style, pause = "straight", 0
    for word in (part.strip() for part in text.split(",") if part.strip()):
        if word.startswith("pause"):
            pause = int(word.split()[1])
        else:
            style = word
    return style, pause


STYLES = r"(?P<styles>(?:\s*,\s*(?:straight|hand-like|jerk|pause\s+\d+))*)"
Rule = tuple[re.Pattern[str], Callable[[LineInterpreter, re.Match[str]], list[Table]]]
RULES: list[Rule] = [
    (re.compile(pattern), make)
    for pattern, make in (
        (rf"rotate\s+(?:{KINDS})?(?P<on>{NAME})\s+by\s+(?P<by>{ANGLE}){ABOUT}{FRAMES}", LineInterpreter._rotate),
        (
            rf"pull\s+(?:{KINDS})?(?P<on>{NAME})(?:\s+at\s+(?P<x>{LENGTH})\s+(?P<y>{LENGTH}))?"
            rf"\s+by\s+(?P<dx>{LENGTH})\s+(?P<dy>{LENGTH}){PINS}{FRAMES}{STYLES}",
            LineInterpreter._pull,
        ),
        (rf"smooth\s+(?:{KINDS})?(?P<on>{NAME})\s+by\s+(?P<strength>{NUMBER}){PINS}{FRAMES}", LineInterpreter._smooth),
        (rf"scale\s+(?:{KINDS})?(?P<on>{NAME})\s+by\s+(?P<factor>{NUMBER}){ABOUT}{FRAMES}", LineInterpreter._scale),
        (rf"arc\s+(?:edge\s+)?(?P<on>{NAME})\s+to\s+(?P<bulge>{NUMBER}){FRAMES}", LineInterpreter._arc),
        (
            rf"insert\s+(?P<name>{NAME})\s+on\s+(?:edge\s+)?(?P<on>{NAME})\s+at\s+(?P<s>{NUMBER})",
            LineInterpreter._insert,
        ),
        (
            rf"hole\s+(?P<name>{NAME})\s+at\s+(?P<x>{LENGTH})\s+(?P<y>{LENGTH})\s+radius\s+(?P<radius>{LENGTH})",
            LineInterpreter._hole,
        ),
        (rf"delete\s+(?:{KINDS})?(?P<on>{NAME})", LineInterpreter._delete),
        (rf"set\s+(?P<key>[^\s=]+)\s*=\s*(?P<value>.+?){FRAMES}", LineInterpreter._set),
        (r"idle\s+(?P<frames>\d+)(?:\s+frames?)?", LineInterpreter._idle),
        (PLAIN, LineInterpreter._plain),
        (
            rf"cloth\s+at\s+(?P<x>{LENGTH})\s+(?P<y>{LENGTH})"
            rf"\s+from\s+(?P<fx>{LENGTH})\s+(?P<fy>{LENGTH})\s+(?P<fz>{LENGTH})"
            rf"\s+by\s+(?P<dx>{LENGTH})\s+(?P<dy>{LENGTH})\s+(?P<dz>{LENGTH}){FRAMES}{STYLES}",
            LineInterpreter._cloth,
        ),
        (
            rf"(?:{KINDS})?(?P<on>{NAME})\s+by\s+(?P<dx>{LENGTH})\s+(?P<dy>{LENGTH})(?:\s+(?P<dz>{LENGTH}))?"
            rf"{FRAMES}{STYLES}",
            LineInterpreter._drag,
        ),
    )
]


def script_from_lines(
    scene: Scene, texts: Sequence[str], seed: int = 0, outline: Outline | None = None
) -> InterpretedLines:
    """The edit script that lines of text describe; empty lines and lines that begin with # are skipped.

    Args:
        scene: that it is for.
        texts: lines, see GRAMMAR.
        seed: of hand-like paths.
        outline: the shape, when it does not come from ``[shape]``.

    Raises:
        UserError: a line that is not understood, or names what is not there.
    """
    return interpreted(LineInterpreter(scene, seed, outline), texts)


def interpreted(interpreter: LineInterpreter, texts: Sequence[str]) -> InterpretedLines:
    """The edit script that a composer makes of lines of text, as `script_from_lines` does."""
    for text in (line for block in texts for line in block.splitlines()):
        if text.strip() and not text.strip().startswith("#"):
            interpreter.add(text)
    return interpreter.result
