"""How the quantities of a frame follow what the hand moves, and the numbers of its scene: beside the replay, which no
row shows."""

# More than 15 modules: a derivative joins shape, mesh, analysis and scene.

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Analysis, Context
from restshape.analysis.frame import Frame
from restshape.analysis.made_analysis import made_analysis
from restshape.errors import ReplayProblem, UserError
from restshape.first_use import made
from restshape.mesh.moved_meshes import copied
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.scene.given_numbers import value_below
from restshape.scene.load import revise
from restshape.sensitivity.outline_velocity import node_velocity, point_velocity
from restshape.shape.hand.gesture import drag

if TYPE_CHECKING:
    from restshape.analysis.restorable import RestorableAnalysis
    from restshape.arrays import Reals
    from restshape.fem.problem import Problem
    from restshape.mesh.lagrange_space import LagrangeSpace
    from restshape.mesh.mesh import Mesh
    from restshape.replay.loop import Replay
    from restshape.replay.request import Request
    from restshape.scene.model import Scene

WAY = 1e-6
"""How far an entity goes to either side, as a share of the size of the shape: quantities are differenced, answers are
not, which follow to first order."""
STEP = 1e-4
"""How far a number goes to either side, as a share of itself, or of 1 where it is 0."""
WAYS_OF_SOLVING = ("mesh", "solve", "version")
"""Tables and keys whose numbers decide how well an answer is known, not what it is: the mesh stays as it lies."""
TOLERANCE = 1e-10
"""Of the solves at both sides of a number, whose answers are differenced."""


class Rates(NamedTuple):
    """What derivatives are taken from.

    Args:
        replay: whose last frame it is; request: what is replayed.
    """

    replay: Replay
    request: Request

    def along_entity(self, name: str) -> dict[str, Reals]:
        """Derivatives (2,) of each quantity by a drag of an entity in x and in y, in its unit a metre.

        Nodes follow harmonically from where they lie, as at a press. The answer follows by its design derivative, on a
        copy of the mesh; the quantity is differenced.

        Raises:
            UserError: there is no such entity, or no derivative.
        """
        self._refuse(name)
        outline = made(self.replay.session.outline)
        gesture, space = drag(outline, outline.entity(name)), copied(self.replay.moving.field_mesh)
        corners = motion(space.mesh, BoundaryNodes(space.mesh).basis(outline, list(made(gesture.basis))), "harmonic")
        ways = space.motion(corners, gesture.basis)
        scene = self.replay.session.scene
        try:
            analysis = self._solved(space, scene)
            if analysis.predictor is None:
                raise UserError(analysis.why_not, name, "ask for the derivative by a number of the scene")
            slopes = analysis.predictor.derivative(ways, min(scene.solve.tolerance, TOLERANCE))
            known, X, plane = analysis.predictor.values(), space.X.copy(), space.mesh.X.copy()
            step, ends = WAY * outline.size, []
            for axis, (corner, way, slope) in enumerate(zip(corners, ways, slopes)):
                for sign in (step, -step):
                    c = (0.0, sign) if axis else (sign, 0.0)
                    space.mesh.X[:] = plane + sign * corner
                    space.X[:] = X + sign * way
                    space.mesh.outline = outline.moved(gesture.points(c))
                    space.mesh.geometry += 1
                    analysis.predictor.set_values(known + sign * slope)
                    ends.append(analysis.observe())
        except ReplayProblem as problem:
            raise UserError(f"there is no derivative: {problem}", name, "move on, and ask there") from problem
        return {
            one: np.array([ends[0][one] - ends[1][one], ends[2][one] - ends[3][one]]) / (2.0 * step) for one in ends[0]
        }

    def by_number(self, key: str) -> dict[str, Reals]:
        """Derivatives of each quantity by a number of the scene, in its unit a SI unit of the number.

        By central differences of two solves on the mesh as it lies; where the number gives the shape, nodes follow.
        Answers that hang on the way to them, as of cloth, are solved for from that of the frame.

        Raises:
            UserError: there is no such number, or no derivative.
        """
        self._refuse(key)
        scene = self.replay.session.scene
        if key.split(".")[0] in WAYS_OF_SOLVING:
            what = "quantities change by this number with the error of the mesh and the solver alone"
            raise UserError(what, key, "ask restshape accuracy how much, or name a number such as material.steel.E")
        value = value_below(scene, tuple(key.split(".")))
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise UserError("this is no number of the scene", key, "name one such as material.steel.E")
        step = STEP * (abs(value) or 1.0)
        scenes = [self._changed(key, value + sign, value) for sign in (step, -step)]
        mesh = self.replay.moving.field_mesh
        try:
            along = point_velocity(mesh.outline, scene, scenes, step)
            ways = None if along is None else node_velocity(mesh, along)
            ahead, behind = (
                self._solved(_moved(copied(mesh), along, ways, sign), _exact(end)).observe()
                for end, sign in zip(scenes, (step, -step), strict=True)
            )
        except ReplayProblem as problem:
            raise UserError(f"there is no derivative: {problem}", key, "choose another value of it") from problem
        return {name: np.array((ahead[name] - behind[name]) / (2.0 * step)) for name in ahead}

    def _changed(self, key: str, value: float, here: float) -> Scene:
        """The scene with another value of a number beside the one that it has here.

        Raises:
            UserError: it may not have that value.
        """
        try:
            return revise(self.replay.session.scene, key, value)
        except UserError as error:
            what = f"there is no derivative at {here:g}, for {value:g} is refused: {error.what}"
            raise UserError(what, key, "choose another value of it") from error

    def _refuse(self, where: str) -> None:
        """Refuses frames that are not solved on a mesh of an outline, each for itself."""
        replay = self.replay
        application = self.request.application
        if not application.editing.has_mesh or application.transient(replay.session.scene):
            what = f"a frame of this scene of {application.name!r} does not follow from its shape alone"
            raise UserError(what, where, "derivatives are of steady answers and of modes, on a mesh of an outline")
        if not replay.solver.known or replay.solver.predicted or replay.row["refused"]:
            raise UserError("the frame has no solution of its own", where, "ask for one that is solved")

    def _solved(self, space: Mesh | LagrangeSpace, scene: Scene) -> Analysis[Problem]:
        """An analysis of its own that has solved the frame on a mesh: where there are several answers, from its own."""
        request = self.request
        context = Context(self.replay.comm, request.policy, request.calibration, Stages(), guided=False)
        analysis = made_analysis(scene, request.application, context)
        cells, hand = np.arange(len(space.cells), dtype=np.int32), (None, (0.0, 0.0))
        known: RestorableAnalysis | None = getattr(self.replay.analysis, "restorable", None)
        own: RestorableAnalysis | None = getattr(analysis, "restorable", None)
        if known is not None and own is not None:
            own.restore(known.kept_answer(), Frame(space, cells, None, self.replay.session.scene, hand))
        analysis.solve(Frame(space, cells, None, scene, hand))
        return analysis


def _moved(
    space: Mesh | LagrangeSpace, along: Reals | None, ways: tuple[Reals, Reals] | None, part: float
) -> Mesh | LagrangeSpace:
    """A mesh of its own whose outline and nodes go a part of their velocities, if they have any.

    Args:
        space: the mesh; along: (k, 2) of the control points; ways: of corners and of nodes; part: of them.
    """
    if along is None or ways is None:
        return space
    space.mesh.X += part * ways[0]
    if space is not space.mesh:
        space.X += part * ways[1]
    space.mesh.outline = space.outline.moved(space.outline.points + part * along)
    return space


def _exact(scene: Scene) -> Scene:
    """A scene whose solves are exact enough to be differenced; an effect that has their tolerance leaves it to them."""
    solve = scene.solve.model_copy(update={"tolerance": min(scene.solve.tolerance, TOLERANCE)})
    effects = {
        name: {key: value for key, value in settings.items() if key != "tolerance"}
        for name, settings in scene.effects.items()
    }
    return scene.model_copy(update={"solve": solve, "effects": effects})
