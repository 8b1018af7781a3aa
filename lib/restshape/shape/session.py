"""An edit session: events of a script turned into frames, each with a valid shape."""

# More than 15 modules: each kind of edit has a module of its own.

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from restshape.application import Application
from restshape.arrays import Reals
from restshape.bounds import REACH
from restshape.errors import UserError
from restshape.scene.bodies import bodies_of
from restshape.scene.dart_event import DrawnDart
from restshape.scene.dart_keys import dart_of_part
from restshape.scene.darts import darts_of
from restshape.scene.edit_script import (
    Arc,
    Delete,
    Drag,
    Hole,
    Insert,
    Press,
    Pull,
    Release,
    Rotate,
    Scale,
    Script,
    Set,
    Smooth,
    names_in_space,
)
from restshape.scene.event_line import EventLine
from restshape.scene.given_numbers import edited_number
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.panels import panels_of
from restshape.scene.plan import plan, refuse_switched
from restshape.shape import topology_edits
from restshape.shape.build import outline_of
from restshape.shape.given_shape import Follow, ShapeFollower
from restshape.shape.gradual import sweep
from restshape.shape.hand import gesture as gestures
from restshape.shape.hand import rigid_body_drag
from restshape.shape.hand.arc_grab import bent, grab_arc, is_arc
from restshape.shape.hand.both_halves import image_of, of_both_halves, reflected, twice
from restshape.shape.hand.fairing import smooth
from restshape.shape.hand.gesture import Gesture
from restshape.shape.hand.hand_map import map_of, refuse_map
from restshape.shape.hand.handpath import resampled
from restshape.shape.hand.panel_drag import fold_beside, refuse_foreign_part, turned_panel
from restshape.shape.hand.pin_drag import begin_space_grab
from restshape.shape.hand.pull import pull
from restshape.shape.hand.shape_grab import Grab, ShapeGrab
from restshape.shape.hand.space_grab import SpaceGrab
from restshape.shape.outline import Entity, Outline
from restshape.shape.panels.dart_drawing import with_drawn_dart, without_dart
from restshape.shape.references import parts_of_edits, refuse_lost_names, without_lost_sizes
from restshape.shape.script_frame import ScriptFrame
from restshape.shape.script_session import STILL, GrabbedStep, ScriptSession, State, Step
from restshape.shape.validity import MotionCheck, problem, too_far

OF_SHAPE = ("pull", "smooth", "arc", "insert", "delete")
"""Events on parts of the shape, never on bodies."""
Turn = Callable[[Outline, Entity, Reals], Gesture]
"""Makes the gesture of an entity about a point (2,) [m]."""
Coefficients = Callable[[float], tuple[float, float]]
"""Coefficients of a gesture at the part of it that is done."""


@dataclass(slots=True)
class EditFrame(ScriptFrame):
    """One frame of a session of shapes, which always has an outline."""

    outline: Outline


class EditSession(ScriptSession[Outline]):
    """Replays a script's events on a scene's shape.

    Args:
        scene: where the session starts.
        script: validated events.
        application: whose effects the scene may name; default: the scene's own.
        outline: the shape, when it does not come from the scene's ``[shape]`` (imported meshes).

    Raises:
        UserError: the scene's shape is not valid.
    """

    def __init__(
        self, scene: Scene, script: Script, application: Application | None = None, outline: Outline | None = None
    ) -> None:
        super().__init__(scene, script, application)
        self.outline = outline if outline is not None else outline_of(scene)
        refuse_lost_names(scene, self.outline)
        self._columns = self._application.own_columns(scene)
        self._grab: Grab | SpaceGrab | None = None
        self._mark()

    def _frame(self, when: tuple[int, float, int, str], step: Step, analysed: bool, last: bool) -> EditFrame:
        edit_ended = step.change == "none" or (self._grab is None and last)
        hand = None if self._grab is None else (self._grab.name, self._grab.cursor[:2])
        index, t, line, do = when
        return EditFrame(
            index,
            t,
            line,
            do,
            step.change,
            step.gesture,
            step.c,
            self.scene,
            step.refused,
            self.outline,
            analysed=analysed,
            edit_ended=edit_ended,
            hand=hand,
        )

    def _carried_out(self, event: EventLine) -> Iterator[Step]:
        if event.do in OF_SHAPE and (on := getattr(event, "on", None)) in bodies_of(self.scene):
            what = f"{on} is a body, which {event.do!r} does not know"
            why = UserError(what, do="bodies can be pressed and dragged, rotated and scaled")
            return self._refused(event.frame_count, why)
        return super()._carried_out(event)

    @property
    def grabbed(self) -> Gesture | None:
        """The gesture of the hand that holds the shape; None where none does, or holds a body."""
        return None if self._grab is None else self._grab.gesture

    @property
    def cursor(self) -> tuple[float, ...] | None:
        """Where the hand is [m]; None where it holds nothing."""
        return None if self._grab is None else self._grab.cursor

    def rollback(self) -> None:
        """Restores shape, scene and history as they were before the last step that changed any: it has no solution.

        The hand stays where it is, so that a drag moves on from the cursor.
        """
        self.outline, self.scene, c, self._past, self._future = self._before
        if self._grab is not None:
            self._grab.c = c

    def _mark(self) -> None:
        c = STILL if self._grab is None else self._grab.c
        self._before = self.outline, self.scene, c, self._past, self._future

    def _state(self) -> State[Outline]:
        return self.outline, self.scene

    def _do_press(self, event: Press) -> Iterator[Step]:
        try:
            grab = begin_space_grab(self.outline, self.scene, event.on, event.at)
            if grab is not None:
                refuse_map(event)
                self._grab = grab
                yield Step("none")
                return
            entity = self.outline.entity(event.on, names_in_space(self.scene) or ())
            tensor, mirror = map_of(event)
            if mirror is None:
                mirror = fold_beside(self.outline, self.scene, entity)
            gesture = gestures.drag(self.outline, entity, tensor, mirror)
        except UserError as error:
            yield self._refusal(error)
            return
        origin = event.at if event.at is not None else self.outline.centroid(entity).tolist()
        yield self._take(gesture, (origin[0], origin[1]), event.on)

    def _do_pull(self, event: Pull) -> Iterator[Step]:
        try:
            if event.pins is None and is_arc(self.outline, event.on):
                self._grab = grab_arc(self.outline, self.scene, event.on, event.at)
                yield Step("none", **self._grab.still())
                return
            gesture, place = pull(self.outline, event.on, event.at, event.pins)
            gesture = of_both_halves(gesture, self.outline, self.scene, self.outline.entity(event.on))
        except UserError as error:
            yield self._refusal(error)
            return
        yield self._take(gesture, place if event.at is None else event.at, event.on)

    def _take(self, gesture: Gesture, origin: tuple[float, float], name: str) -> Step:
        """The hand takes hold, the cursor being at the origin."""
        check, before = MotionCheck(self.outline, gesture), (self.outline, self.scene)
        reach = REACH * self.outline.size
        self._grab = ShapeGrab(gesture, origin, origin, before, name=name, check=check, reach=reach)
        return Step("none", gesture=gesture)

    def _do_drag(self, event: Drag) -> Iterator[Step]:
        grab, to = self._grab, [] if event.to is None else [event.to]
        if grab is None:
            yield from self._refused(event.frame_count, "nothing is grabbed")
            return
        try:
            path = grab.through(to if event.path is None else event.path)
        except UserError as why:
            yield from self._refused(event.frame_count, why)
            return
        if event.frames is not None and event.frames != len(path):
            begin, *rest = grab.whole_way(path)
            path = resampled(tuple(begin), rest, event.frames)
        for point in path:
            yield grab.dragged(self, point)

    def _do_release(self, event: Release) -> Iterator[Step]:
        grab, self._grab = self._grab, None
        if grab is None:
            yield Step("none", "nothing is grabbed")
            return
        step = grab.let_go(self)
        self._remember(grab.before)
        yield step

    def _do_rotate(self, event: Rotate) -> Iterator[Step]:
        if event.on in bodies_of(self.scene):
            yield from self._change_body(event, rigid_body_drag.turned, lambda part: part * event.by)
            return

        if event.on in panels_of(self.scene):
            yield from self._turn_panel(event)
            return

        def coefficients(part: float) -> tuple[float, float]:
            # 1 - cos would lose the digits of small angles.
            return -2.0 * float(np.sin(0.5 * part * event.by)) ** 2, float(np.sin(part * event.by))

        yield from self._turn(event, gestures.rotate, coefficients)

    def _turn_panel(self, event: Rotate) -> Iterator[Step]:
        """A whole panel turns in the pattern plane, about its middle where no point is named."""
        scene, centre = self.scene, self.outline.centroid(self.outline.entity(event.on)).tolist()
        about = event.about if event.about is not None else (centre[0], centre[1])
        yield from self._revise_evenly(
            event.frames, lambda part: turned_panel(scene, event.on, part * event.by, (about[0], about[1]))
        )

    def _do_scale(self, event: Scale) -> Iterator[Step]:
        if event.on in bodies_of(self.scene):
            yield from self._change_body(event, rigid_body_drag.scaled, lambda part: 1.0 + part * (event.factor - 1.0))
            return
        yield from self._turn(event, gestures.scale, lambda part: (part * (event.factor - 1.0), 0.0))

    def _do_smooth(self, event: Smooth) -> Iterator[Step]:
        def make() -> Gesture:
            found = smooth(self.outline, event.on, event.strength, event.pins)
            return of_both_halves(found, self.outline, self.scene, self.outline.entity(event.on))

        yield from self._sweep(event.frames, make, lambda part: (part, 0.0))

    def _turn(self, event: Rotate | Scale, make: Turn, coefficients: Coefficients) -> Iterator[Step]:
        def gesture() -> Gesture:
            entity = self.outline.entity(event.on, bodies_of(self.scene))
            about = np.array(event.about) if event.about is not None else self.outline.centroid(entity)
            return of_both_halves(make(self.outline, entity, about), self.outline, self.scene, entity)

        yield from self._sweep(event.frames, gesture, coefficients)

    def _sweep(self, frames: int, make: Callable[[], Gesture], coefficients: Coefficients) -> Iterator[Step]:
        """A gesture carried out in equal parts, without a hand: `coefficients` are its c at the part done so far."""
        before = self._state()
        try:
            gesture = make()
        except UserError as error:
            yield from self._refused(frames, error)
            return
        check, reached = MotionCheck(self.outline, gesture), STILL
        for i in range(1, frames + 1):
            c = coefficients(i / frames)
            wanted = self.outline.moved(gesture.points(c))
            way = float(np.abs(wanted.points - before[0].points).max())
            # Curves that bend are resampled: the samples of the motion are those of the shape before it.
            wrong = too_far(wanted, (way, 0.0)) or check.problem(c) or problem(wanted)
            if wrong is not None:
                yield Step("none", wrong, gesture=gesture, c=reached)
                continue
            self.outline = wanted
            yield Step("move", gesture=gesture, c=c)
            if self.outline is wanted:
                reached = c
        self._remember(before)

    def _do_arc(self, event: Arc) -> Iterator[Step]:
        before = self._state()
        try:
            edge, goal = self._arc_goal(event)
            twice(self.outline, self.scene, event.on, lambda outline, _, __: outline)
        except UserError as error:
            yield from self._refused(event.frames, error)
            return
        start = float(self.outline.bulges[edge])
        gesture = gestures.bend(self.outline)
        for i in range(1, event.frames + 1):
            bulge = goal if i == event.frames else start + (goal - start) * i / event.frames
            wanted = twice(self.outline, self.scene, event.on, partial(bent, bulge=bulge))
            wrong = problem(wanted)
            change = "none"
            if wrong is None:
                change = "move" if wanted.topology == self.outline.topology else "shape"
                self.outline = wanted
            yield Step(change, wrong, gesture=gesture if change == "move" else None)
        self._remember(before)

    def _arc_goal(self, event: Arc) -> tuple[int, float]:
        edges = self.outline.entity(event.on)
        if len(edges.edges) != 1 or edges.vertices or edges.loops:
            raise UserError(f"{event.on} is not one edge")
        edge = edges.edges[0]
        goal = event.bulge
        if goal is None:
            goal = topology_edits.bulge_of(self.outline, edge, np.array(event.through))
        topology_edits.as_arc(self.outline, edge, goal)
        return edge, goal

    def _do_set(self, event: Set) -> Iterator[Step]:
        try:
            key = edited_number(self.scene, event.key, event.value)
            self._refuse_fixed(key)
            part_of = sweep(self.scene, key, event.value) if event.frames > 1 else None
        except UserError as error:
            yield from self._refused(event.frames, error)
            return
        if part_of is None:
            yield from self._revise_evenly(1, lambda _: revise(self.scene, key, event.value))
        else:
            yield from self._revise_evenly(event.frames, lambda part: part_of(self.scene, part))

    def _change_body(
        self, event: Rotate | Scale, change: rigid_body_drag.Change, amount: Callable[[float], float]
    ) -> Iterator[Step]:
        """A body whose form is that at first, turned or scaled by the amount of the part of the event that is done."""
        kind, form = rigid_body_drag.form_of(self.scene, event.on)

        def revised(part: float) -> Scene:
            return rigid_body_drag.with_form(self.scene, event.on, kind, change(kind, form, amount(part), event.about))

        yield from self._revise_evenly(event.frames, revised)

    def _revise_evenly(self, frames: int, revised: Callable[[float], Scene]) -> Iterator[Step]:
        """Scenes of the part of an event that is done, a frame each; all of them are undone at once."""
        before, follower = self._state(), ShapeFollower(self.outline, self.scene)
        for i in range(1, frames + 1):
            yield self.revised(partial(revised, i / frames), partial(follower, part=i / frames, whole=revised))
        if self._grab is None:
            self._remember(before)

    def revised(self, wanted: Callable[[], Scene], follow: Follow | None = None) -> Step:
        """One frame of an edit that changes the scene, and of the shape what parameters give of it.

        Args:
            wanted: gives the scene.
            follow: goes along with the shape; None: it stays.
        """
        before = self._state()
        try:
            self.scene = self.scene.with_parts(parts_of_edits(self.scene, self.outline))
            self.scene = wanted()
            refuse_lost_names(self.scene, self.outline)
            refuse_switched(before[1], self.scene, self._application)
            self._refuse_fixed_changes(before[1])
            self._refuse_new_columns()
            way = follow(self.outline, self.scene) if follow else None
            if way is not None:
                self._refuse_while_grabbed()
                self.outline = way.outline
        except UserError as error:
            self.outline, self.scene = before
            return self._refusal(error)
        change = self._scene_change(before[1], self.scene)
        if way is None:
            return Step(change, **self._grabbed())
        if self.outline.topology != before[0].topology:
            return Step("shape")
        return Step("move", gesture=way.gesture, c=way.c) if change == "values" else Step(change)

    def _refuse_while_grabbed(self) -> None:
        """Refuses a change of the shape beneath the hand that holds it."""
        if self._grab is not None and self._grab.gesture is not None:
            what = f"this changes the shape, of which the hand holds {self._grab.name}"
            raise UserError(what, do="release it first")

    def _refuse_new_columns(self) -> None:
        """Refuses what would show numbers, such as a further mode, that the replay's table has no column for."""
        new = [name for name in self._application.own_columns(self.scene) if name not in self._columns]
        if bodies := sorted({".".join(name.split(".")[:2]) for name in new if name.startswith("bodies.")}):
            what = f"{', '.join(bodies)}: a replay has the bodies of its first frame, and of the same kinds"
            raise UserError(what, do="have it in the scene from the start, out of the way, and move it")
        if new:
            those = f"{', '.join(new)} {'is' if len(new) == 1 else 'are'} not among them"
            what = f"the columns of a replay are those of its first frame, and {those}"
            raise UserError(what, do="ask for as many from the start")

    def _do_insert(self, event: Insert) -> Iterator[Step]:
        def cut(outline: Outline, on: str, image: bool) -> Outline:
            name = (image_of(self.scene, event.name) or event.name) if image else event.name
            at = event.at
            if at is not None:
                at = reflected(self.outline, self.scene, on, at) if image else at
            return topology_edits.insert(outline, on, name, None if at is None else np.array(at), event.s)

        yield self._cut(lambda: twice(self.outline, self.scene, event.on, cut), event.name)

    def _do_dart(self, event: DrawnDart) -> Iterator[Step]:
        scene, outline = self.scene, self.outline
        yield from self._revise_evenly(1, lambda _: with_drawn_dart(scene, outline, event))

    def _do_delete(self, event: Delete) -> Iterator[Step]:
        if event.on in darts_of(self.scene):
            yield from self._revise_evenly(1, lambda _: without_dart(self.scene, event.on))
            return

        if dart := dart_of_part(self.scene.shape.darts, event.on):
            what = f"{event.on} is a part of the dart {dart.key!r}"
            yield self._refusal(UserError(what, do=f"delete {dart.key}, the whole dart"))
            return

        def cut(outline: Outline, on: str, _: bool) -> Outline:
            return topology_edits.delete(outline, on)

        yield self._cut(lambda: twice(self.outline, self.scene, event.on, cut))

    def _do_hole(self, event: Hole) -> Iterator[Step]:
        if event.name in bodies_of(self.scene):
            yield self._refusal(UserError(f"a body has the name {event.name!r} already", do="choose another name"))
            return

        def cut(outline: Outline, name: str, image: bool) -> Outline:
            def place(point: tuple[float, float]) -> tuple[float, float]:
                return reflected(self.outline, self.scene, name, point) if image else point

            centre = None if event.center is None else place(event.center)
            corners = None if event.polygon is None else [place(point) for point in event.polygon]
            return topology_edits.add_hole(outline, name, centre, event.radius, corners)

        yield self._cut(lambda: twice(self.outline, self.scene, event.name, cut), event.name)

    def _cut(self, operation: Callable[[], Outline], new: str | None = None) -> Step:
        """One frame of an edit that gives another layout, with a part of a new name or none."""
        before = self._state()
        try:
            wanted = operation()
            refuse_lost_names(self.scene, wanted, self.outline)
        except UserError as error:
            return self._refusal(error)
        wrong = problem(wanted)
        if wrong is not None:
            return Step("none", wrong)
        try:
            if new is not None:
                refuse_foreign_part(wanted, self.scene, new)
        except UserError as error:
            return self._refusal(error)
        self.scene = without_lost_sizes(self.scene, wanted, self.outline)
        self.outline = wanted
        self._remember(before)
        return Step("shape")

    def _go_to(self, then: State[Outline], kind: str) -> Step:
        now = self._state()
        self.outline, self.scene = then
        change = self._scene_change(now[1], then[1])
        if now[0] is then[0]:
            return Step(change)
        if now[0].topology != then[0].topology or change != "values":
            return Step("shape")
        gesture = gestures.towards(kind, *(state[0] for state in (now, then)))
        return Step("move", gesture=gesture, c=(1.0, 0.0))

    def _scene_change(self, old: Scene, new: Scene) -> str:
        """The change "mesh" where mesh settings or the effects that are simulated differ, else "values"."""
        effects = [{e.name for e in plan(scene, self._application).effects if e.on} for scene in (old, new)]
        return "values" if old.mesh == new.mesh and effects[0] == effects[1] else "mesh"

    def _grabbed(self) -> GrabbedStep:
        return {} if self._grab is None else self._grab.still()
