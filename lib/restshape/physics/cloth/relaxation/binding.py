"""What a frame changes about cloth before it is solved for: values, mesh, places of the material, bodies, friction."""

# More than 15 modules: all that a frame may change about cloth meets here.

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from restshape.analysis.frame import Frame
from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import transfer
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.body_motion import is_remade
from restshape.physics.cloth.contact.contact import FrictionHistory
from restshape.physics.cloth.contact.tunnelling import deepened, penetrations
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.relaxation.beginning import beginning, start_notes
from restshape.physics.cloth.relaxation.drag_frame import LastRest, drag_frame
from restshape.physics.cloth.relaxation.follow_bodies import follow_bodies
from restshape.physics.cloth.relaxation.jumps import Expected, farthest
from restshape.physics.cloth.relaxation.keep_apart import kept_apart
from restshape.physics.cloth.relaxation.pull_supports import pull_supports
from restshape.physics.cloth.relaxation.relaxation_options import RelaxationOptions
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.relaxation.taken_along import taken_along
from restshape.physics.cloth.scene import ClothArguments, cloth_problem, kernel_body, set_contact, set_values
from restshape.physics.cloth.seams.seam_lines import SeamPair
from restshape.physics.cloth.self_contact.layer_friction import LayerFriction
from restshape.physics.cloth.self_contact.layer_order import is_another_order
from restshape.physics.cloth.sheet.material_motion import in_frames
from restshape.scene.model import Scene
from restshape.scene.panels import frames_of

log = logging.getLogger("restshape.physics")


AGAIN = "layers would cross from the last positions: the cloth was dropped again"


def bind(
    before: RelaxationState, frame: Frame, new_mesh: bool, options: RelaxationOptions, origin: RelaxationState | None
) -> tuple[RelaxationState, bool]:
    """The state that a frame's relaxation starts from, and whether that is the initial placement.

    Args:
        before: the last equilibrium.
        frame: as an analysis knows it.
        new_mesh: the mesh, or its connectivity, is another one.
        options: of the frame's scene.
        origin: the equilibrium of other cloth on the same mesh to start from instead, its friction included.
    """
    scene, same_mesh = frame.scene, not new_mesh and before.geometry == frame.mesh.geometry
    usual = options.context.policy.warm and options.strategy == "auto" and not (origin or before.guessed)
    if usual and same_mesh and before.problem is not None and not before.interrupted:
        taken = taken_along(before, scene, options.bodies)
        if taken is not None:
            return replace(taken, plan=options.plan), False
    arguments = options.arguments(frame.mesh)
    apart = _touches_itself(before)
    # Cloth that has fallen out of reach is thrown again, so that an edit, or its undo, brings it back.
    cold = before.problem is None or not options.context.policy.warm or before.report.falls
    # Nothing passes, so that another order of layers needs another beginning.
    cold = cold or is_another_order(before.problem.order, arguments.order)
    state = _placed(before, frame, new_mesh, options, arguments, cold)
    log.info("Relaxation from %s", "the initial placement" if cold and not origin else "the last positions")
    problem, notes = state.problem, ()
    if cold:
        begun = beginning(problem, arguments, options.strategy == "auto" and not origin)
        state, notes = replace(state, x=begun.x), tuple(start_notes(problem, begun, scene))
        notes += tuple(problem.seams.ease_notes()) if problem.seams else ()
    state.solver.set_tolerance(options.settings.tolerance)
    state.solver.set_reach(options.reach)
    state = replace(state, report=ConvergenceReport(), notes=notes, doubts=(), expected=None)
    known = before.x if before.x.shape == state.x.shape and before.problem is problem else state.x
    if usual and not cold:
        start = in_material(before, problem) if before.problem is problem else known
        problem.begin_frame(start)
    resized = any(is_remade(old, new) for old, new in zip(before.bodies, state.bodies))
    if not (cold or origin or resized) and before.problem is problem and options.strategy == "auto":
        state, found = drag_frame(state, _last_rest(before, problem))
        if found:
            return replace(state, observer=problem.observer(scene.quantities)), False
    if not cold:
        state = _followed(state, before, known)
    if origin:
        state, cold = _from_origin(state, origin), False
    acts = problem.begin(state.x)
    if apart and not (acts or cold or origin):
        # Contact cannot undo what a new mesh, or a support, has brought across.
        state, cold = _dropped_again(state, arguments, known, before.energy, options.strategy == "auto"), True
        acts = problem.begin(state.x)
    if cold and not acts:
        state = replace(state, notes=(*state.notes, begins_across(problem, state.x, scene)))
    return replace(state, observer=problem.observer(scene.quantities)), cold


def _last_rest(before: RelaxationState, problem: ClothProblem) -> LastRest:
    """The last equilibrium as a frame of the same problem begins at it, whose material may have moved."""
    x, old = in_material(before, problem), before.place
    still = x.copy()
    still[problem.corner_number] = before.x[problem.corner_number]
    X = in_frames(old.X, old.pieces, old.frames, problem.place.frames)
    tensions = problem.membrane.tensions(X, before.x)
    return LastRest(x, before.bodies, old.farthest(problem.place), before.energy, still, tensions)


def _touches_itself(before: RelaxationState) -> bool:
    """Whether contact of the cloth with itself acts at the last equilibrium: there nothing crosses."""
    own = before.problem.self_contact if before.problem is not None else None
    return own is not None and own.active


def _placed(
    before: RelaxationState,
    frame: Frame,
    new_mesh: bool,
    options: RelaxationOptions,
    arguments: ClothArguments,
    cold: bool,
) -> RelaxationState:
    """The state with problem and solver of a frame, where the last equilibrium is, or anywhere of a cold start."""
    if new_mesh or not same_elements(before.problem, arguments):
        corners = None
        if not cold:
            with options.context.stages("map"):
                corners = moved_corners(before, frame, frame.scene)
        state = new_problem(before, frame, arguments, corners)
        state = replace(state, solver=options.make_solver(state.problem))
    else:
        state = moved_material(before, arguments)
    return replace(state, plan=options.plan, bodies=options.bodies)


def _followed(state: RelaxationState, before: RelaxationState, known: np.ndarray) -> RelaxationState:
    """The state with supports and bodies where they are in the frame, from the last positions known (n, 3)."""
    problem = state.problem
    state, known = pull_supports(state, before.bodies, known)
    if problem.self_contact:
        state = kept_apart(state, known)
    if problem.contact and before.friction is not None:
        state = follow_bodies(state, before.bodies, np.where(problem.boundary.mask, known, state.x))
        if brought_deep(state, before):
            # Forces that push cloth out of a body that has come deep into it are not those that friction is of.
            problem.end_frame(state.x)
    return state


def brought_deep(state: RelaxationState, before: RelaxationState) -> bool:
    """Whether bodies are deeper in the cloth than contact is thick, and were not where it rested before."""
    problem, old = state.problem, before.problem
    depths, thickness = penetrations(problem.contact, problem.corners(state.x)), problem.contact.thickness
    if max(depths, default=0.0) <= thickness:
        return False
    bodies = [kernel_body(body) for body in before.bodies]
    return deepened(penetrations(old.contact, old.corners(before.x), bodies), depths, thickness)


def _from_origin(state: RelaxationState, origin: RelaxationState) -> RelaxationState:
    """The state at the equilibrium of other cloth on the same mesh, with its friction."""
    problem = state.problem
    if problem.contact and origin.friction is not None:
        problem.contact.history = origin.friction
    if problem.self_contact and origin.layers is not None:
        problem.self_contact.history = origin.layers
    return replace(state, x=problem.constrain(origin.x), softness=origin.softness)


def _dropped_again(
    state: RelaxationState, arguments: ClothArguments, known: np.ndarray, energy: float, retreating: bool
) -> RelaxationState:
    """The state at the initial placement, which is not to be trusted to lie as the edit would have had it.

    Args:
        known: (n, 3) the last positions, from which the cloth has jumped; energy: of the cloth there [J].
        retreating: half-spaces may retreat, see `retreats`.
    """
    problem = state.problem
    log.info("Relaxation from the initial placement after all: the last positions cross themselves")
    hand = farthest(problem, problem.constrain(known) - known)
    expected = state.expected or Expected(known, hand, 0.0, energy, energy)
    expected = replace(expected, energy=expected.work, derive=None, dropped=True)
    doubts, x = (*state.doubts, AGAIN), beginning(problem, arguments, retreating).x
    problem.end_frame(x)
    return replace(state, x=x, doubts=doubts, expected=expected)


def begins_across(problem: ClothProblem, x: np.ndarray, scene: Scene) -> str:
    """What there is to say of cloth that begins at x (n, 3) across itself: it passes through itself until it is apart.

    Raises:
        UserError: the scene says that it touches itself.
    """
    corners = problem.corners(x)
    crossed = problem.surface.crossed(corners)
    if len(crossed):
        place = ", ".join(f"{1e3 * value:.0f}" for value in corners[problem.mesh.cells[crossed[0]]].mean(axis=0))
        what = f"cloth begins across itself at {len(crossed)} triangles, first at ({place}) mm"
    else:
        what = "cloth begins across itself in its own plane"
    if scene.effects.get("contact", {}).get("self"):
        raise UserError(
            what, "start", "start it elsewhere, or leave out effects.contact.self to let it come apart first"
        )
    return f"{what}: it must come apart"


def restored(
    kept: RelaxationState, before: RelaxationState, frame: Frame, options: RelaxationOptions
) -> RelaxationState:
    """An equilibrium that there was, with problem and solver of a frame that has its mesh and scene.

    Args:
        kept: the equilibrium.
        before: the last one, whose problem serves where the mesh has the same cells.
        frame: as an analysis knows it; options: of its scene.
    """
    mesh, arguments = frame.mesh, options.arguments(frame.mesh)
    if mesh is before.mesh and mesh.topology == before.topology and same_elements(before.problem, arguments):
        problem = before.problem
        set_values(problem, arguments)
        set_contact(problem, arguments)
    else:
        problem = cloth_problem(mesh, arguments)
    # A factor of what was undone would lead what follows to other folds.
    solver = options.make_solver(problem)
    if kept.friction is not None:
        problem.contact.history = kept.friction
    problem.begin(kept.x)
    if kept.layers is not None:
        problem.self_contact.history = kept.layers
    solver.set_tolerance(options.settings.tolerance)
    solver.set_reach(options.reach)
    # What was counted was counted then.
    report = replace(kept.report, steps=0, newton=0, iterations=0, factors=0)
    versions = {"topology": mesh.topology, "geometry": mesh.geometry}
    setup = {"problem": problem, "solver": solver, "observer": problem.observer(frame.scene.quantities)}
    found = replace(kept, scene=frame.scene, plan=options.plan, bodies=options.bodies, interrupted=False)
    return replace(found, report=report, place=problem.place, **versions, **setup)


def same_elements(problem: ClothProblem, arguments: ClothArguments) -> bool:
    """Whether the elements of a problem are those of other arguments."""
    fabric, new, contact = problem.fabric, arguments.fabric, problem.contact
    if (contact is None) != (not arguments.bodies) or (problem.self_contact is None) != (arguments.layers is None):
        return False
    known = problem.seams.pairs if problem.seams else ()
    if len(known) != len(arguments.seams) or not all(map(SeamPair.joins_the_same, known, arguments.seams)):
        return False
    if contact is not None and len(contact.bodies) != len(arguments.bodies):
        return False
    return (fabric.kind, fabric.law) == (new.kind, new.law)


def new_problem(
    before: RelaxationState, frame: Frame, arguments: ClothArguments, corners: np.ndarray | None
) -> RelaxationState:
    """The state on a mesh, or with elements, that are not known.

    Args:
        before: the state before.
        frame: with the mesh.
        arguments: of the problem.
        corners: (corners, 3) [m] where the last cloth is on that mesh; None: it starts cold, elsewhere.
    """
    problem, old = cloth_problem(frame.mesh, arguments), before.problem
    known = None if corners is None or frame.mesh is old.mesh else mesh_in_frames(before, frame.scene)
    x = problem.flat(arguments.start if corners is None else corners)

    def interpolate(values: np.ndarray) -> np.ndarray:
        return values if known is None else transfer(known, frame.mesh, values)

    friction = before.friction if corners is not None and problem.contact else None
    if corners is not None and before.layers is not None and problem.self_contact:
        problem.self_contact.hold(corners, before.layers.mapped(old.corners(before.x), interpolate))
    if friction is not None and len(friction.anchors) == len(problem.contact.bodies):
        at_nodes = friction.at_corners(len(old.mesh.X)).mapped(old.corners(before.x), corners, interpolate)
        problem.contact.history = replace(at_nodes, points=problem.contact.points)
        _carry_points(before, problem, corners, frame.scene)
    return replace(before, problem=problem, x=x)


def _carry_points(before: RelaxationState, problem: ClothProblem, corners: np.ndarray, scene: Scene) -> None:
    """Let points of triangles at corners (n, 3) [m] have the friction of those nearest in the material before."""
    contact, friction, old = problem.contact, before.friction, before.problem
    contact.cut(corners)
    points, known = contact.points, friction.points
    if not len(points.cut) or not len(known.cut):
        return
    place, found = contact.place(corners), contact.history
    n = len(corners)
    material = points.place(problem.mesh.X)[n:]
    # The material where the nodes of the last equilibrium were.
    frames = tuple(frames_of(before.scene).values()), tuple(frames_of(scene).values())
    X = in_frames(before.place.X[old.corner_number], old.mesh.node_piece, *frames)
    nearest = cKDTree(known.place(X)).query(material)[1]
    offsets = known.place(old.corners(before.x)) - friction.anchors
    anchors, limits = found.anchors.copy(), found.limits.copy()
    anchors[:, n:] = place[n:] - offsets[:, nearest]
    limits[:, n:] = friction.limits[:, nearest]
    contact.history = replace(found, anchors=anchors, limits=limits)


def moved_corners(before: RelaxationState, frame: Frame, scene: Scene) -> np.ndarray:
    """Positions (corners, 3) of the last frame: along the cloth, or, on a new mesh, by their displacements."""
    problem = before.problem
    if frame.mesh is problem.mesh:
        return before.advected.corners_at(frame.mesh.X, problem.corner_number, tuple(frames_of(scene).values()))
    # Panels that only lie elsewhere in the pattern plane stay where they are.
    old, placement = mesh_in_frames(before, scene), InitialPlacement(scene)
    moved = problem.corners(before.x) - placement.places(old)
    return placement.places(frame.mesh) + transfer(old, frame.mesh, moved)


def mesh_in_frames(before: RelaxationState, scene: Scene) -> Mesh:
    """The mesh of the last equilibrium with its panels where a scene lays them; itself where they lie there."""
    mesh, now, wanted = before.problem.mesh, frames_of(before.scene), frames_of(scene)
    if now == wanted or now.keys() != wanted.keys():
        return mesh
    X = in_frames(mesh.X, mesh.node_piece, tuple(now.values()), tuple(wanted.values()))
    return replace(mesh, X=X)


def moved_material(before: RelaxationState, arguments: ClothArguments) -> RelaxationState:
    """The state with moved nodes, other values, supports and bodies on the same topology."""
    problem = before.problem
    # Material that has come elsewhere takes the place that the cloth has there.
    set_values(problem, arguments)
    x = in_material(before, problem)
    set_contact(problem, arguments)
    # What sticks does so wherever its nodes are in it.
    way = problem.corners(x) - problem.corners(before.x)
    if problem.self_contact:
        problem.self_contact.history = before.layers.moved(way)
    if problem.contact:
        friction, contact = before.friction, problem.contact
        contact.history = friction
        way = contact.place(problem.corners(x)) - contact.place(problem.corners(before.x))
        problem.contact.history = replace(friction, anchors=friction.anchors + way)
    return replace(before, x=problem.constrain(x))


def in_material(before: RelaxationState, problem: ClothProblem) -> np.ndarray:
    """Unknowns (n, 3) of the last cloth where the nodes of its problem are in the material now."""
    return before.advected.unknowns_at(problem.place, problem.morley.side_number if problem.morley else None)


def layers_of(problem: ClothProblem) -> LayerFriction | None:
    """What friction between layers remembers now; None where cloth does not touch itself."""
    return problem.self_contact.history if problem.self_contact else None


def friction_of(problem: ClothProblem) -> FrictionHistory | None:
    """What friction remembers now; None where nothing touches."""
    return problem.contact.history if problem.contact else None
