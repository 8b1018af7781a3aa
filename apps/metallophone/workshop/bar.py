"""A bar as its maker sees it: the shape of a frame with its holes, its modes, where it is hung and struck."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from restshape_apps.metallophone.sounding.place import mode_shapes, on_plate

from restshape.analysis.modal.hanging import Hanging, HangingPoints, hanging_of
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.modal.pitch import cents_between, frequency_of, note
from restshape.analysis.settings import HangingSettings, modal_settings
from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.export.cut_drawing import tables_with_circles
from restshape.export.edited_frame import EditedFrame, plain_scene
from restshape.interface.first_frame import replayed_to
from restshape.mesh.transfer import Transfer
from restshape.scene.load import remade
from restshape.shape.nearness import distances
from restshape.shape.outline import Outline

Holes = Mapping[str, tuple[Reals, float]]
"""Centre (2,) and radius [m] of each, by name."""
SAMPLES = 97
"""Places between the hanging points that are looked at."""
FAINT = 0.1
"""Share of the root mean square of a mode's deflections below which a place is still."""
ARM = 1.5e-3
"""Half the length of the lines of an engraved cross [m]."""
WALL = 1.0
"""Distance of a hole for the cord from the border, from its middle on, over its diameter."""
ALMOST = 0.9
"""Share of the largest deflection from which on a place counts as near it."""


@dataclass(frozen=True, eq=False)
class Bar:
    """A bar at a frame.

    Args:
        frame: whose shape and values it has.
        analysis: of it with its holes, on a mesh of its own.
        hanging: of the bar without the holes that are drilled for the cord.
        holes: that are drilled for the cord.
        undrilled: frequencies (modes,) [Hz] without these holes.
        target: name of the tone that it is to have, or the nearest; wanted: whether it was asked for.
    """

    frame: EditedFrame
    analysis: ModalAnalysis
    hanging: HangingPoints
    holes: Holes
    undrilled: Reals
    target: str
    wanted: bool

    @property
    def outline(self) -> Outline:
        """The shape with its holes."""
        mesh = self.analysis.state.space.mesh
        return mesh.outline

    @property
    def a4(self) -> float:
        """The frequency of A4 [Hz]."""
        return modal_settings(self.analysis.state.plan).a4

    @property
    def cents(self) -> float:
        """How many cents the first mode lies above the target."""
        first = float(self.analysis.frequencies[0])
        # A tone below the octave -1 is the nearest, but cannot be asked for.
        return cents_between(first, frequency_of(self.target, self.a4)) if self.wanted else note(first, self.a4)[1]

    @property
    def drilled_cents(self) -> float:
        """By how many cents the holes for the cord move the first mode."""
        return cents_between(float(self.analysis.frequencies[0]), float(self.undrilled[0]))

    @cached_property
    def strike(self) -> Reals:
        """The place (2,) [m] that is struck: of those between both hanging points where the first mode moves most.

        Without hanging points, or where the way from one to the other leaves the bar or is still, it is where the
        first mode moves most of all, with room for a cross.
        """
        space, (start, end) = self.analysis.space, self.hanging.places
        between = start + np.linspace(0.2, 0.8, SAMPLES)[:, None] * (end - start)
        corners = space.X[space.cells[:, :3]]
        if not (self.hanging.found and all(on_plate(corners, place) for place in between)):
            return self._most_moved()
        shape = np.ascontiguousarray(mode_shapes(self.analysis)[0])
        size, share = np.linalg.norm(Transfer(space, between)(shape), axis=1), np.linspace(0.0, 1.0, SAMPLES)
        if size.max() < FAINT * np.sqrt((shape**2).sum(axis=1).mean()):
            return self._most_moved()
        near = np.flatnonzero(size >= ALMOST * size.max())
        # The deflection is linear on each triangle: the top of a parabola through it depends less on the mesh.
        bend, slope, _ = np.polyfit(share[near], size[near], 2)
        best = -0.5 * slope / bend if bend < 0.0 else float(share[np.argmax(size)])
        return between[0] + min(max(best, 0.0), 1.0) * (between[-1] - between[0])

    @cached_property
    def room(self) -> Reals:
        """Distances (n,) [m] of the nodes of the plane mesh from the nearest edge of the outline or of a hole."""
        outline = self.outline
        chains = [outline.polyline(e) for loop in outline.loops if loop.kind != "region" for e, _ in loop.edges]
        starts, ends = (np.concatenate([chain[part] for chain in chains]) for part in (slice(-1), slice(1, None)))
        return distances(self.analysis.space.X, starts, ends)

    def _most_moved(self) -> Reals:
        """The node (2,) [m] at which the first mode moves most, of those that a cross has room around."""
        size = np.linalg.norm(mode_shapes(self.analysis)[0], axis=1)
        size[self.room < min(2.0 * ARM, 0.5 * float(self.room.max()))] = 0.0
        return self.analysis.space.X[int(size.argmax())].copy()


def bar_of(frame: EditedFrame, args: argparse.Namespace) -> Bar:
    """The bar of a frame, with holes for the cord where the options want them.

    Raises:
        UserError: no place to hang it is fixed, or a hole leaves the bar.
    """
    analysis = _solved(frame, {})
    asked = modal_settings(analysis.state.plan).hanging
    hanging = hanging_of(analysis.state, _room(asked or Hanging(), args.cord))
    holes = _holes(hanging, args.cord, bool(asked and asked.at)) if args.cord else {}
    undrilled = analysis.frequencies.copy()
    if holes:
        try:
            # On the triangles that lie around the holes, so that the difference is that of the holes alone.
            undrilled = _solved(frame, holes, "regions").frequencies.copy()
            analysis = _solved(frame, holes)
        except UserError as error:
            raise UserError(error.what, "--cord", "give a smaller diameter, or leave it out") from error
    a4 = modal_settings(analysis.state.plan).a4
    asked_for = args.to or _named_tone(frame)
    target = asked_for or note(float(analysis.frequencies[0]), a4)[0]
    return Bar(frame, analysis, hanging, holes, undrilled, target, bool(asked_for))


def _room(asked: HangingSettings, diameter: float) -> Hanging:
    """What is asked of hanging points, with room for holes: half a diameter of material stays beside each."""
    margin = max(asked.margin, WALL * diameter)
    return Hanging(asked.weights, asked.mode, asked.at, asked.apart, margin)


def _named_tone(frame: EditedFrame) -> str:
    """The tone that a quantity compares the first mode with; empty where none does."""
    quantities = frame.scene.quantities.values()
    found = [getattr(one, "cents", None) for one in quantities if getattr(one, "mode", None) in (None, 1)]
    return next((str(name) for name in found if name), "")


def _holes(hanging: HangingPoints, diameter: float, judged: bool) -> Holes:
    """The holes for a cord.

    Raises:
        UserError: the scene names places of its own, or there are none.
    """
    if judged:
        what = "the scene names the places at which the bar is hung"
        raise UserError(what, "--cord", "draw the holes in the scene, or leave effects.modal.hanging.at out")
    if not hanging.found:
        what = f"no place to hang the bar is fixed: {hanging.why}"
        raise UserError(what, "--cord", "give a smaller diameter, or leave it out")
    return {f"hang_{k}": (place, 0.5 * diameter) for k, place in enumerate(hanging.places, 1)}


def _solved(frame: EditedFrame, holes: Holes, kind: str = "holes") -> ModalAnalysis:
    """The modes of the shape of a frame, on a new mesh, with round holes or regions besides."""
    tables = plain_scene(frame, {"shape": tables_with_circles(frame.outline, holes, kind)})
    return replayed_to(remade(frame.scene, tables), None, None).analysis
