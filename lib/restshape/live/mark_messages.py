"""Marks of applications as they travel: see `MarkMessage` of `page/src/protocol.ts`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from restshape.interface.plain import plain
from restshape.live.frame_arrays import MessageBody
from restshape.live.shown_marks import Arrows, Chart, Lines, NodeValue, Offer, Tone, Words


def placed(mark: object, body: MessageBody) -> dict[str, object]:
    """What the header of a message says of a mark, whose arrays are added to its body."""
    said = _SAID.get(type(mark))
    if said is None:
        raise TypeError(f"{type(mark).__name__} is no mark")
    return said(mark, body)


def _lines(mark: Lines, body: MessageBody) -> dict[str, object]:
    said = {"kind": "lines", "name": mark.name, "meaning": mark.meaning, "words": list(mark.words)}
    return said | {"starts": list(map(int, mark.starts))} | _places(mark, body)


def _arrows(mark: Arrows, body: MessageBody) -> dict[str, object]:
    said = {"kind": "arrows", "name": mark.name, "meaning": mark.meaning, "unit": mark.unit, "words": list(mark.words)}
    vectors = {"vectors": body.add(mark.vectors), "tips": [bool(one) for one in mark.tips]}
    return said | vectors | _places(mark, body)


def _words(mark: Words, body: MessageBody) -> dict[str, object]:
    at = None if mark.at is None else _numbers(mark.at)
    moved = {} if mark.moved is None else {"moved": _numbers(mark.moved)}
    return {"kind": "words", "text": mark.text, "at": at, "meaning": mark.meaning, **moved}


def _value(mark: NodeValue, body: MessageBody) -> dict[str, object]:
    return {"kind": "value"} | vars(mark)


def _offer(mark: Offer, body: MessageBody) -> dict[str, object]:
    slide = plain(mark.slide)
    said = {"kind": "offer", "name": mark.name, "text": mark.text, "events": plain(mark.events)}
    return said | {"slide": slide, "slid": mark.slid, "lines": [placed(one, body) for one in mark.lines]}


def _chart(mark: Chart, body: MessageBody) -> dict[str, object]:
    curves = [{"name": name, "x": _numbers(x), "y": _numbers(y)} for name, (x, y) in mark.curves.items()]
    said = {"kind": "chart", "name": mark.name, "xLabel": mark.x_label, "yLabel": mark.y_label, "curves": curves}
    return said | {"at": {name: float(x) for name, x in mark.at.items()}, "logarithmic": mark.logarithmic}


def _tone(mark: Tone, body: MessageBody) -> dict[str, object]:
    partials = {key: _numbers(getattr(mark, key)) for key in ("frequencies", "decays", "amplitudes")}
    place = {key: None if (one := getattr(mark, key)) is None else _numbers(one) for key in ("at", "moved")}
    return {"kind": "tone", "name": mark.name, **place, **partials}


def _places(mark: Lines | Arrows, body: MessageBody) -> dict[str, object]:
    """Where its points are, and their displacements where it has any; or the nodes that say both."""
    if mark.nodes is not None:
        return {"nodes": body.add(mark.nodes)}
    places: dict[str, object] = {"points": body.add(mark.points)}
    return places if mark.moved is None else places | {"moved": body.add(mark.moved)}


def _numbers(values: Iterable[float]) -> list[float]:
    return [*map(float, values)]


_SAID: dict[type, Callable[[Any, MessageBody], dict[str, object]]] = {
    Lines: _lines,
    Arrows: _arrows,
    Words: _words,
    NodeValue: _value,
    Offer: _offer,
    Chart: _chart,
    Tone: _tone,
}
"""What says it of each kind of mark."""
