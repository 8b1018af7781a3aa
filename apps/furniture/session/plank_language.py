"""Edit scripts of furniture from short lines of text, such as "drag leg-4 length y by 8 cm in 30 frames"."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from restshape_apps.furniture.scene.plank_events import PLANK_EVENTS
from restshape_apps.furniture.session.grammar import GRAMMAR
from restshape_apps.furniture.session.plank_session import PlankSession

from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.scene.units import quantity
from restshape.shape.outline import Outline
from restshape.shape.script_language import ANGLE, FRAMES, LENGTH, NAME, NUMBER, PLAIN, LineInterpreter, length

FASTENED = rf"(?:\s+with\s+(?P<fastener>{NAME}))?"
PARAMETER = r"(?:move|turn) [xyz]|length [xy]"


def _triple(prefix: str, number: str = LENGTH) -> str:
    """The pattern of three numbers."""
    return r"\s+".join(rf"(?P<{prefix}{axis}>{number})" for axis in "xyz")


def _place(match: re.Match, prefix: str) -> list[float]:
    """Three lengths [m] of a text."""
    return [length(match[f"{prefix}{axis}"]) for axis in "xyz"]


class PlankInterpreter(LineInterpreter):
    """Turns lines of text into events of furniture."""

    grammar = GRAMMAR
    events = PLANK_EVENTS

    def _begin(self, scene: Scene, outline: Outline | None) -> Any:
        return PlankSession(scene, Script.empty(scene))

    def _rules(self) -> list[tuple[re.Pattern, Callable[..., list[dict[str, Any]]]]]:
        return PLANK_RULES

    def _move(self, match: re.Match) -> list[dict[str, Any]]:
        planks = {plank.name: plank for plank in self._session.design.piece.planks}
        plank = planks.get(match["on"])
        start = [0.0, 0.0, 0.0] if plank is None else [float(f"{value:.9g}") for value in plank.centre]
        to = [round(a + b, 9) for a, b in zip(start, _place(match, "d"))]
        return self._grab_and_drag({"do": "press", "on": match["on"], "at": start}, {"do": "drag", "to": to}, match)

    def _change(self, match: re.Match) -> list[dict[str, Any]]:
        kind = match["parameter"].split()[0]
        by = quantity(match["by"], "angle") if kind == "turn" else length(match["by"])
        press = {"do": "press", "on": match["on"], "parameter": match["parameter"]}
        return self._grab_and_drag(press, {"do": "drag", "by": by}, match)

    def _grab_and_drag(self, press: dict[str, Any], drag: dict[str, Any], match: re.Match) -> list[dict[str, Any]]:
        return [press, _timed(drag, match), {"do": "release"}]

    def _rotate(self, match: re.Match) -> list[dict[str, Any]]:
        event = {"do": "rotate", "on": match["on"], "by": quantity(match["by"], "angle")}
        return [_timed(event | ({"about": match["axis"]} if match["axis"] else {}), match)]

    def _scale(self, match: re.Match) -> list[dict[str, Any]]:
        event = {"do": "scale", "on": match["on"], "factor": float(match["factor"])}
        return [_timed(event | ({"along": match["axis"]} if match["axis"] else {}), match)]

    def _plank(self, match: re.Match) -> list[dict[str, Any]]:
        places = {key: _place(match, prefix) for key, prefix in (("from", "a"), ("to", "b"), ("width", "w"))}
        thick = {"thickness": length(match["thick"])} if match["thick"] else {}
        return [{"do": "plank", "name": match["name"], **places, **thick, **_made(match, "wood", "fastener")}]

    def _connect(self, match: re.Match) -> list[dict[str, Any]]:
        return [{"do": "connect", "on": match["on"], **_made(match, "fastener")}]

    def _weight(self, match: re.Match) -> list[dict[str, Any]]:
        at = {} if match["px"] is None else {"at": [float(match[f"p{axis}"]) for axis in "xyz"]}
        return [{"do": "weight", "name": match["name"], "on": match["on"], "mass": match["mass"].strip(), **at}]

    def _choose(self, match: re.Match) -> list[dict[str, Any]]:
        return [{"do": "choose", "number": int(match["number"])}]

    def _slide(self, match: re.Match) -> list[dict[str, Any]]:
        return [_timed({"do": "slide", "to": float(match["to"])}, match)]


def _made(match: re.Match, *keys: str) -> dict[str, str]:
    """Those keys of an event that the text gives."""
    return {key: match[key] for key in keys if match[key]}


def _timed(event: dict[str, Any], match: re.Match) -> dict[str, Any]:
    """The event with its number of frames."""
    return {**event, "frames": int(match["frames"] or 1)}


PLANK_RULES: list[tuple[re.Pattern, Callable[..., list[dict[str, Any]]]]] = [
    (re.compile(pattern), make)
    for pattern, make in (
        (rf"(?:drag\s+)?(?P<on>{NAME})\s+by\s+{_triple('d')}{FRAMES}", PlankInterpreter._move),
        (
            rf"(?:drag\s+)?(?P<on>{NAME})\s+(?P<parameter>{PARAMETER})\s+by\s+(?P<by>{ANGLE}|{LENGTH}){FRAMES}",
            PlankInterpreter._change,
        ),
        (
            rf"rotate\s+(?P<on>{NAME})\s+by\s+(?P<by>{ANGLE})(?:\s+about\s+(?P<axis>[xyz]))?{FRAMES}",
            PlankInterpreter._rotate,
        ),
        (
            rf"scale\s+(?P<on>{NAME})\s+by\s+(?P<factor>{NUMBER})(?:\s+along\s+(?P<axis>[xy]))?{FRAMES}",
            PlankInterpreter._scale,
        ),
        (
            rf"plank\s+(?P<name>{NAME})\s+from\s+{_triple('a')}\s+to\s+{_triple('b')}\s+width\s+{_triple('w')}"
            rf"(?:\s+thick\s+(?P<thick>{LENGTH}))?(?:\s+of\s+(?P<wood>{NAME}))?{FASTENED}",
            PlankInterpreter._plank,
        ),
        (rf"connect\s+(?P<on>{NAME}){FASTENED}", PlankInterpreter._connect),
        (
            rf"weight\s+(?P<name>{NAME})\s+of\s+(?P<mass>{NUMBER}\s*(?:kg|g|t)?)\s+on\s+(?P<on>{NAME})"
            rf"(?:\s+at\s+{_triple('p', NUMBER)})?",
            PlankInterpreter._weight,
        ),
        (rf"delete\s+(?P<on>{NAME})", PlankInterpreter._delete),
        (r"choose\s+(?P<number>\d+)", PlankInterpreter._choose),
        (rf"slide\s+to\s+(?P<to>{NUMBER}){FRAMES}", PlankInterpreter._slide),
        (rf"set\s+(?P<key>{NAME})\s*=\s*(?P<value>.+?){FRAMES}", PlankInterpreter._set),
        (r"idle\s+(?P<frames>\d+)", PlankInterpreter._idle),
        (PLAIN, PlankInterpreter._plain),
    )
]
