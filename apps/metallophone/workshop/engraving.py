"""What is engraved on a bar: its tone, and crosses where it is hung and where it is struck."""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from restshape_apps.metallophone.workshop.bar import ARM, Bar, bar_of

from restshape.arrays import Reals
from restshape.export.cut_drawing import EngravedText, Engraving, with_holes
from restshape.export.edited_frame import EditedFrame, plain_scene
from restshape.export.kept_formulas import with_formulas
from restshape.export.shape_tables import shape_tables
from restshape.scene.load import remade
from restshape.scene.model import Scene
from restshape.scene.plain_values import table_in

LOW, HIGH = 1.5e-3, 8e-3
"""Least and largest height of letters [m]."""
SHARE = 0.6
"""Height of letters over the distance of their middle from what is nearest."""


def engraving(frame: EditedFrame, args: argparse.Namespace) -> Engraving:
    """The holes for the cord, and what is engraved on the bar of a frame.

    Raises:
        UserError: as of `bar_of`.
    """
    bar = bar_of(frame, args)
    hung = bar.hanging.places if bar.hanging.found and not bar.holes else np.zeros((0, 2))
    strike = bar.strike
    return Engraving(bar.holes, np.vstack([hung, strike]), ARM, (_tone(bar, strike),), notes_on(bar))


def drilled(frame: EditedFrame, args: argparse.Namespace) -> tuple[EditedFrame, list[str]]:
    """The frame with the holes for the cord in its shape, the same without; what there is to note.

    Raises:
        UserError: as of `bar_of`.
    """
    if not args.cord:
        return frame, []
    bar = bar_of(frame, args)
    whole = replace(frame, outline=with_holes(frame.outline, bar.holes))
    return replace(whole, scene=_hung_at(whole, list(bar.holes))), notes_on(bar)


def _hung_at(frame: EditedFrame, holes: list[str]) -> Scene:
    """The scene of a frame whose bar is hung at holes from now on."""
    shape = with_formulas(shape_tables(frame.outline), frame.scene, frame.outline)
    tables = plain_scene(frame, {"shape": shape})
    effects = table_in(tables, "effects")
    modal = table_in(effects, "modal")
    hanging = {**table_in(modal, "hanging"), "at": holes}
    return remade(frame.scene, {**tables, "effects": {**effects, "modal": {**modal, "hanging": hanging}}})


def _tone(bar: Bar, strike: Reals) -> EngravedText:
    """The name of the tone, where there is most room for it."""
    space, room = bar.analysis.space, bar.room
    for cross in (strike, *(bar.hanging.places if bar.hanging.found else ())):
        room = np.minimum(room, np.hypot(*(space.X - cross).T) - ARM)
    best = int(room.argmax())
    return EngravedText(bar.target, space.X[best].copy(), float(np.clip(SHARE * room[best], LOW, HIGH)))


def notes_on(bar: Bar) -> list[str]:
    """What there is to note: the tone on a mesh of its own, what drilling does, why there are no hanging points."""
    f = float(bar.analysis.frequencies[0])
    found = [f"{f:.2f} Hz on a mesh of its own, {bar.cents:+.1f} cents from {bar.target}"]
    if bar.holes:
        found.append(f"the holes for the cord move the first tone by {bar.drilled_cents:+.2f} cents")
    if not bar.hanging.found:
        found.append(f"no hanging points: {bar.hanging.why}")
    return found
