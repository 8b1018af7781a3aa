"""An edit session of furniture: events of a script turned into frames, each with a piece."""

# More than 15 modules: each kind of edit has a module of its own.

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from restshape_apps.furniture.guidance.amounts import amount
from restshape_apps.furniture.guidance.design import Design, DesignDirection, Guidance
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.guidance.weights_along import weights_along
from restshape_apps.furniture.physics.plank_findings import LENGTH
from restshape_apps.furniture.scene.plank_events import far_turn
from restshape_apps.furniture.session.boards import MovingBoards
from restshape_apps.furniture.session.chosen_settings import setting_key, setting_note, thickened_by
from restshape_apps.furniture.session.plank_changes import CHANGES, plank_number
from restshape_apps.furniture.session.plank_frame import Grab, PlankFrame, State
from restshape_apps.furniture.session.set_keys import after_set, refuse_others, taken_back
from restshape_apps.furniture.session.without_effect import without_effect
from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.plank_adoption import adopted
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece, Plank

from restshape.application import Application
from restshape.errors import UserError
from restshape.scene.edit_script import Script
from restshape.scene.given_numbers import edited_number
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.plan import plan, refuse_switched
from restshape.shape.gradual import sweep
from restshape.shape.hand.handpath import resampled
from restshape.shape.script_session import ScriptSession, Step

TO_A_POINT = "a plank is dragged to a point: use 'to', or press a parameter of it"
BY_A_NUMBER = "a parameter is dragged by a number: use 'by', or press the plank without a parameter"

STRAIGHT = 9
"""Decimals of the direction of a hand that count."""


class PlankSession(ScriptSession):
    """Replays a script's events on a scene's piece.

    Args:
        scene: where the session starts.
        script: validated events.
        application: whose effects the scene may name; default: the scene's own.

    Raises:
        UserError: the scene's piece cannot be had.
    """

    outline = None
    """Planks have none."""

    def __init__(self, scene: Scene, script: Script, application: Application | None = None) -> None:
        super().__init__(scene, script, application)
        try:
            self.design = Design.closed(piece_of(scene), self._guidance())
        except UserError as error:
            # What names no place is a fastener that does not suit its planks.
            raise scene.located(UserError(error.what, error.where or "fastener.name", error.do)) from error
        self.gamma = self._rest()
        self.design_direction: DesignDirection | None = None
        self.part = 0.0
        self._grab: Grab | None = None
        self._chosen: tuple[Design, Suggestion] | None = None
        self._mark()

    @property
    def grabbed(self) -> DesignDirection | None:
        """The parameter under the hand; None where there is none."""
        return self.design_direction

    @property
    def grabbed_at(self) -> np.ndarray | None:
        """The place (3,) [m] where the hand took hold of a plank; None where it has none, or only a parameter of it."""
        return None if self._grab is None or self._grab.number is not None else self._grab.origin

    @property
    def cursor(self) -> tuple[float, ...] | None:
        """Where the hand is [m]; None where it holds no plank, or only a parameter of one."""
        if self._grab is None or self._grab.number is not None:
            return None
        return tuple(self._grab.cursor.tolist())

    @property
    def chosen(self) -> Suggestion | None:
        """The suggestion that can be slid along; None where there is none."""
        return None if self._chosen is None else self._chosen[1]

    def _carried_out(self, event: Any) -> Iterator[Step]:
        self.design_direction = self.design_direction if self._grab else None
        return super()._carried_out(event)

    def rollback(self) -> None:
        """Restore all as it was before the last step: it has no solution."""
        (
            self.design,
            self.scene,
            self.gamma,
            self.design_direction,
            self.part,
            self._past,
            self._future,
            self._chosen,
        ) = self._before

    def _mark(self) -> None:
        now = (self.design, self.scene, self.gamma, self.design_direction, self.part)
        self._before = (*now, self._past, self._future, self._chosen)

    def _frame(self, when: tuple[int, float, int, str], step: Step, analysed: bool, last: bool) -> PlankFrame:
        edit_ended = self._grab is None and (last or step.change == "start")
        contents = (step.change, self.design_direction, (self.part, 0.0), self.scene, step.refused)
        frame = PlankFrame(
            *when, *contents, self.design, self.gamma, step.note, analysed=analysed, edit_ended=edit_ended
        )
        return frame

    def _state(self) -> State:
        return self.design, self.scene

    # What a hand does.

    def _do_press(self, event: Any) -> Iterator[Step]:
        try:
            plank = plank_number(self.design.piece, event.on)
        except UserError as error:
            yield self._refusal(error)
            return
        free = np.array([(plank, number) in self.design.freedoms for number in range(8)])
        number = None if event.parameter is None else FREEDOMS.index(event.parameter)
        if not (free[:3].any() if number is None else free[number]):
            yield Step("none", self.design.why_fixed(plank, number))
            return
        origin = self.design.piece.planks[plank].centre if event.at is None else np.array(event.at)
        if number is not None:
            origin, self.design_direction, self.part = np.zeros(3), self.design.parameter(plank, number), 0.0
        self._grab = Grab((self.design, self.scene), plank, number, origin, origin, free)
        yield Step("none")

    def _do_drag(self, event: Any) -> Iterator[Step]:
        grab, count = self._grab, event.frame_count
        by, wrong = self._by(event)
        if wrong:
            yield from self._refused(count, wrong)
            return
        path = event.path or [event.to] if by is None else [(by, 0.0, 0.0)]
        for cursor in map(np.array, resampled(grab.cursor, path, count)):
            grab.cursor = cursor
            yield self._drag_to(grab, cursor - grab.origin)

    def _by(self, event: Any) -> tuple[float | None, str]:
        """How far a parameter is dragged [m or rad], None for a plank; and why it cannot be, if so."""
        grab, by = self._grab, event.by
        if grab is None:
            return None, "nothing is grabbed"
        if (by is None) != (grab.number is None):
            return None, TO_A_POINT if grab.number is None else BY_A_NUMBER
        if by is None:
            return None, ""
        name = FREEDOMS[grab.number]
        turns = name.startswith("turn")
        amount = by.angle if turns else by.length
        if amount is None:
            kinds = ("an angle", "a length") if turns else ("a length", "an angle")
            return None, f"{name} is dragged by {kinds[0]}, not by {kinds[1]}"
        return amount, str((turns and far_turn(amount)) or "")

    def _drag_to(self, grab: Grab, shift: np.ndarray) -> Step:
        """One frame of a drag that is as far as a shift (3,) from where it began."""
        if grab.number is not None:
            return self._along(self.design_direction, float(shift[0]))
        plank = self.design.piece.planks[grab.plank]
        own = plank.axes.T @ shift
        blocked = ~grab.free[:3] & (np.abs(own) > 1e-9)
        note = _left_out(plank, np.where(blocked, own, 0.0)) if blocked.any() else ""
        own = np.where(grab.free[:3], own, 0.0)
        far = float(np.linalg.norm(own))
        if far == 0.0:
            return self._along(self.design_direction, 0.0, note)
        # A hand that goes straight on goes along one direction, whose range is known from its first frame on.
        unit = np.round(own / far, STRAIGHT) + 0.0
        back = (0.0 - unit).tobytes()
        if back in grab.design_directions:
            # On the other side of where it was taken it is still the same direction.
            return self._along(grab.design_directions[back], -far, note)
        design_direction = grab.design_directions.get(unit.tobytes())
        if design_direction is None:
            direction = np.zeros((len(self.design.piece.planks), 8))
            direction[grab.plank, :3] = unit
            towards = ", ".join(f"{part:.3g}" for part in (np.round(plank.axes @ unit, 3) + 0.0).tolist())
            name = f"{plank.name}: move"
            design_direction = self.design.design_direction(direction, f"{name} along ({towards})", name)
            grab.design_directions[unit.tobytes()] = design_direction
        return self._along(design_direction, far, note)

    def _along(self, design_direction: DesignDirection | None, t: float, note: str = "") -> Step:
        """The frame at a parameter of a design direction; a plank without length is refused."""
        gamma = self._rest() if design_direction is None else t * design_direction.direction
        if np.array_equal(gamma, self.gamma):
            self.design_direction, self.part = design_direction, t
            return Step("none", note=note)
        raw = self.design.furniture.kernel.shape(gamma)
        least = self.design.furniture.compliance.least_overlap
        if raw["fault"] == LENGTH or raw["size"].min() <= 0.0:
            short = np.flatnonzero(~(raw["size"][:, :2].min(axis=1) >= least))
            names = " and ".join(self.design.piece.planks[k].name for k in short)
            return Step("none", f"{names} would have no length left: a plank keeps {amount(least, 'm')} at least")
        self.design_direction, self.part, self.gamma = design_direction, t, gamma
        return Step("move", note=note)

    def _do_release(self, event: Any) -> Iterator[Step]:
        grab, self._grab = self._grab, None
        if grab is None:
            yield Step("none", "nothing is grabbed")
            return
        self._settle()
        self.design_direction, self.part = None, 0.0
        self._remember(grab.before)
        yield Step("none", note=weights_along(grab.before[0].piece, self.design.piece))

    def _do_rotate(self, event: Any) -> Iterator[Step]:
        yield from self._parameter(event, f"turn {event.about}", lambda plank: event.by)

    def _do_scale(self, event: Any) -> Iterator[Step]:
        axis = "xy".index(event.along)
        yield from self._parameter(
            event, f"length {event.along}", lambda plank: (event.factor - 1.0) * float(plank.size[axis])
        )

    def _parameter(self, event: Any, name: str, amount: Callable[[Plank], float]) -> Iterator[Step]:
        """A parameter of a plank changed by an amount in even steps, without a hand."""
        try:
            plank = plank_number(self.design.piece, event.on)
        except UserError as error:
            yield from self._refused(event.frames, error)
            return
        number = FREEDOMS.index(name)
        if (plank, number) not in self.design.freedoms:
            yield from self._refused(event.frames, self.design.why_fixed(plank, number))
            return
        design_direction = self.design.parameter(plank, number)
        yield from self._swept(design_direction, 0.0, amount(self.design.piece.planks[plank]), event.frames)

    def _swept(self, design_direction: DesignDirection, first: float, last: float, frames: int) -> Iterator[Step]:
        """Even steps along a direction of this design; the piece at the last one is where further edits begin."""
        before = self._state()
        for i in range(1, frames + 1):
            step = self._along(design_direction, last if i == frames else first + (last - first) * i / frames)
            if i == frames:
                self._settle()
                self._remember(before)
            yield step

    # Edits of what the piece is made of.

    def _changed(self, event: Any) -> Iterator[Step]:
        """One frame of an edit that gives another piece."""
        before = self._state()
        try:
            piece, note = CHANGES[event.do](self.design.piece, self.scene, event)
            self.design = Design.closed(piece, self.design.guidance)
        except UserError as error:
            yield self._refusal(error)
            return
        self.gamma, self._chosen = self._rest(), None
        self._remember(before)
        yield Step("shape", note=note)

    _do_plank = _do_connect = _do_weight = _do_delete = _changed

    # Suggestions.

    def _do_choose(self, event: Any) -> Iterator[Step]:
        suggestion_list = self.design.suggestion_list.found
        if event.number > len(suggestion_list):
            there = f"there are {len(suggestion_list)}" if suggestion_list else "there is none"
            yield Step("none", f"there is no suggestion {event.number}: {there} for this piece")
            return
        before, suggestion = (self.design, self.scene), suggestion_list[event.number - 1]
        base, gone = self.design, ""
        if suggestion.settings:
            gone = "".join(setting_note(self.scene, *one) for one in suggestion.settings)
            try:
                scene = self.scene
                for key, value in suggestion.settings:
                    scene = revise(scene, setting_key(scene, key, value), value)
                self.design = Design.closed(suggestion.piece, self._guidance(scene))
            except UserError as error:
                yield self._refusal(error)
                return
            self.scene, self._chosen, change = scene, None, "values"
        elif suggestion.piece is not None:
            self.design = Design.closed(_with_own_names(suggestion.piece), base.guidance)
            self._chosen = None
            change = "shape"
        else:
            self.design = base.moved(suggestion.t * suggestion.direction)
            self._chosen = base, suggestion
            change = "move"
        self.gamma = self._rest()
        self._remember(before)
        yield Step(change, note=f"suggestion {event.number}: {suggestion.summary}{gone}")

    def _do_slide(self, event: Any) -> Iterator[Step]:
        if self._chosen is None:
            yield from self._refused(event.frames, "no suggestion is chosen that could be slid along")
            return
        before, (base, suggestion) = (self.design, self.scene), self._chosen
        low, high = suggestion.span
        goal = low + event.to * (high - low)
        design_direction = base.followed(suggestion)
        start, self.design, self.gamma = suggestion.t, base, suggestion.t * suggestion.direction
        for i in range(1, event.frames + 1):
            step = self._along(
                design_direction, goal if i == event.frames else start + (goal - start) * i / event.frames
            )
            if i == event.frames:
                self._settle()
                self._chosen = base, replace(suggestion, t=goal)
                self._remember(before)
            yield step

    # The scene, and what came before.

    def _do_set(self, event: Any) -> Iterator[Step]:
        if self._grab:
            yield from self._refused(event.frames, "nothing can be set while a plank is grabbed")
            return
        before = self._state()
        try:
            key = edited_number(self.scene, event.key, event.value)
            self._refuse_fixed(key)
            self.scene = adopted(self.scene, self.design.piece, key)
            part_of = None if event.frames == 1 else sweep(self.scene, key, event.value)
        except UserError as error:
            self.scene = before[1]
            yield from self._refused(event.frames, error)
            return
        named = self.scene
        for i in range(1, event.frames + 1):
            step = self._revised(key, event.value, part_of, i / event.frames)
            if i == event.frames and not step.refused:
                was, now = (before[0].piece, named), (self.design.piece, self.scene)
                step = replace(step, note=without_effect(key, was, now) or taken_back(*was, self.scene, key))
            yield step
        if self.design is before[0]:
            self.scene = before[1]
        self._remember(before)

    def _revised(self, key: str, value: Any, part_of: Any, part: float) -> Step:
        """One frame of an edit of the scene."""
        before, design = self.scene, self.design
        try:
            self.scene = revise(before, key, value) if part_of is None else part_of(before, part)
            refuse_switched(before, self.scene, self._application)
            self._refuse_fixed_changes(before)
            refuse_others(before, self.scene)
            self.design = Design.closed(after_set(design.piece, before, self.scene, key), self._guidance())
        except UserError as error:
            self.scene, self.design = before, design
            return self._refusal(error)
        self.gamma, self._chosen = self._rest(), None
        return Step("values")

    def _go_to(self, then: State, kind: str) -> Step:
        self.design, self.scene = then
        self.gamma, self._chosen = self._rest(), None
        return Step("shape")

    def _settle(self) -> None:
        """Let further edits begin with the piece as it is now."""
        if self.gamma.any():
            self.design = self.design.moved(self.gamma)
        self.gamma, self._chosen = self._rest(), None

    def _guidance(self, scene: Scene | None = None) -> Guidance:
        """The guidance that a scene asks for; None: the one that is edited."""
        scene = scene or self.scene
        planned = plan(scene, self._application)
        asked, bending = planned.settings("guidance"), planned.on("bending")
        quantities, thickened = scene.quantities, thickened_by(scene)
        if not asked:
            return Guidance(quantities=quantities, thickened=thickened, bending=bending)
        return Guidance(
            asked.ranges,
            asked.suggestions,
            asked.freedoms,
            tuple(asked.keep),
            quantities,
            asked.farthest,
            thickened,
            bending,
        )

    def _rest(self) -> np.ndarray:
        return np.zeros((len(self.design.piece.planks), 8))


def _left_out(plank: Plank, own: np.ndarray) -> str:
    """What a note says of the parts (3,) of a drag, in a plank's own axes, that would open joints or feet."""
    parts = (
        (f"{'-' if own[k] < 0.0 else '+'}{'xyz'[k]}", np.sign(own[k]) * plank.axes[:, k]) for k in range(3) if own[k]
    )
    ways = [f"its {name} ({room_words(axis)} of the room)" for name, axis in parts]
    return f"{plank.name} cannot move along {' or '.join(ways)}: that part of the drag is left out"


def _with_own_names(piece: Piece) -> Piece:
    """The piece whose last plank has a name that no other one has."""
    *others, last = piece.planks
    taken, name, count = {plank.name for plank in others}, last.name, 1
    while name in taken:
        count += 1
        name = f"{last.name}-{count}"
    return replace(piece, planks=(*others, replace(last, name=name)))


def replayed_planks(
    scene: Scene, script: Script, application: Application, *_: Any
) -> tuple[PlankSession, MovingBoards]:
    """The session of a script, and what makes a model of each of its frames.

    Raises:
        UserError: planks make no piece.
    """
    return PlankSession(scene, script, application), MovingBoards()
