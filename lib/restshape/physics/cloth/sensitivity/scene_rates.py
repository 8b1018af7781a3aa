"""How the forces on resting cloth follow a number of its scene: materials, weight, contact, bodies and supports."""

# More than 15 modules: numbers of all parts of cloth enter here.

from __future__ import annotations

from functools import partial

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.fem.assembled import Assembled
from restshape.fem.entity_sets import nodes_on
from restshape.physics.cloth.cloth_supports import AXES
from restshape.physics.cloth.contact.body_motion import taken_rates
from restshape.physics.cloth.contact.mesh_bodies import distance_of
from restshape.physics.cloth.contact.thin_bodies import borne
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.self_contact.layers import stiffness_share
from restshape.physics.cloth.sensitivity.agreed_contact import BodyChange, ContactChange
from restshape.physics.cloth.sensitivity.agreed_layers import AgreedLayers
from restshape.physics.cloth.sensitivity.fabric_rates import fabric_rates
from restshape.physics.cloth.sensitivity.hand_rates import hand_rates
from restshape.physics.cloth.sensitivity.pattern_numbers import draws, lays, pattern_motion
from restshape.physics.cloth.sensitivity.rest_tangent import RestTangent
from restshape.physics.cloth.sensitivity.scene_numbers import SILENT, TABLES, ChangingNumber, is_measure
from restshape.physics.cloth.sheet.fabric import FabricRates
from restshape.scene.bodies import Body, Start
from restshape.scene.duals import Dual, dual
from restshape.scene.expressions import Expression
from restshape.scene.given_numbers import given_numbers, value_below
from restshape.scene.panels import panels_of
from restshape.scene.plain_values import table_in
from restshape.scene.space_values import evaluated
from restshape.shape.placement import rotation, rotation_rates

CHANGING = (*(table for table in TABLES if table != "parameters"), "mesh")
"""Tables whose numbers change a drape: one that a formula gives must be a formula still for its rate to count."""


def scene_rates(state: RelaxationState, tangent: RestTangent, key: str) -> tuple[np.ndarray, np.ndarray]:
    """The rates (n, 3) of the residual, and those (n, 3) of the prescribed unknowns, a unit of a number of the scene.

    Material, formulas, bodies and supports carry dual numbers, or complex steps, to what the elements take; elements
    are linear in their moduli and loads.

    Args:
        state: at rest.
        tangent: there.
        key: dotted, such as "material.cotton.bending", "bodies.ball.sphere.radius" or "effects.gravity.g.2".

    Raises:
        UserError: there is no such number, or one by which drapes have no derivative.
        ReplayProblem: a value has no derivative there.

    Source: docs/theory/design-derivative.md.
    """
    number = ChangingNumber(state.scene, state.plan, key)
    _require_known(state, number)
    problem, x = state.problem, state.x
    fabric = fabric_rates(number, problem.mesh)
    prescribed, turn = _support_rates(state, number)
    out = _material_forces(state, number, fabric)
    out += problem.turned_clamps(x, turn)
    if problem.seams:
        out += _seam_forces(state, number, fabric)
    if tangent.contact:
        out += tangent.contact.rates(change=_contact_change(state, number))
    if problem.self_contact and problem.self_contact.active:
        out += _layer_forces(state, tangent.layers, number, fabric)
    if (moved := pattern_motion(problem.mesh, number)) is not None:
        forces, places = hand_rates(state, tangent, moved)
        return out + forces, prescribed + places
    return out, prescribed


def _require_known(state: RelaxationState, number: ChangingNumber) -> None:
    """Refuse numbers that change more than forces and supports."""
    parts = number.key.split(".")
    if number.key == "effects.contact.self_thickness" or parts[:2] in (["effects", "cloth"], ["effects", "drape"]):
        raise UserError(f"drapes have no derivative by {number.key}", "--by", "name another number")
    if lays(parts):
        raise UserError(f"drapes have no derivative by {number.key}, which lays a panel", "--by", "name another number")
    if is_measure(parts):
        raise UserError(*_resizes(number.key, ".".join(parts)))
    if _places_supported(state, tuple(parts)):
        raise UserError(*_wraps(number.key, parts[1]))
    if number.parameter:
        _require_formulas(state, number)


def _places_supported(state: RelaxationState, key: tuple[str, ...]) -> bool:
    """Whether the number at a key is of the form of a body around which a panel is wrapped that supports hold."""
    scene, panels = state.scene, panels_of(state.scene)
    supported = {on.partition(".")[0] for support in scene.supports.values() for on in support.on}
    # Other names, such as "all", are of several panels.
    wrapped = {panel.around for name, panel in panels.items() if name in supported or supported - panels.keys()}
    return key[0] == "bodies" and key[1] in wrapped and key[-1] != "friction"


def _resizes(key: str, where: str) -> tuple[str, str, str]:
    what = f"drapes have no derivative by {key}, for {where} makes the surface of a mannequin again"
    return what, "--by", "name another number, or compare two replays"


def _wraps(key: str, body: str) -> tuple[str, str, str]:
    what = f"drapes have no derivative by {key}, for supports hold a panel that is wrapped around {body}"
    return what, "--by", "name another number"


def _require_formulas(state: RelaxationState, number: ChangingNumber) -> None:
    """Refuse a parameter of a formula that is none after the scene is read: its rate would be lost."""
    scene = state.scene
    effects = {name: state.plan.settings(name) for name in table_in(scene.raw, "effects")}
    for given in given_numbers(scene.model_copy(update={"effects": effects})):
        table, where = given.key[0], ".".join(given.key)
        if number.parameters.keys().isdisjoint(given.formula.names):
            continue
        if is_measure(given.key):
            raise UserError(*_resizes(number.key, where))
        if _places_supported(state, given.key):
            raise UserError(*_wraps(number.key, given.key[1]))
        if lays(given.key):
            what = f"{number.key} gives {where}, by which drapes have no derivative: it lays a panel"
            raise UserError(what, "--by", "name another number")
        if draws(given.key):
            continue
        now = value_below(effects if table == "effects" else scene, given.key[table == "effects" :])
        if table in CHANGING and given.key[-1] not in SILENT and not isinstance(now, Expression):
            what = f"drapes have no derivative by {number.key}, of which the formula of {where} is made"
            raise UserError(what, "--by", f"write {where} as a number, or name another number")


def _gravity_rate(state: RelaxationState, number: ChangingNumber) -> np.ndarray:
    gravity = state.plan.settings("gravity")
    return number.vector(gravity.g, "effects.gravity.g") if gravity else np.zeros(3)


def _material_forces(state: RelaxationState, number: ChangingNumber, fabric: FabricRates) -> np.ndarray:
    """Rates (n, 3) of the forces of membrane, weight and bending, linear in moduli and loads."""
    problem, x = state.problem, state.x
    loads = fabric.density[:, None] * problem.g + problem.lumped.density[:, None] * _gravity_rate(state, number)
    parts = [problem.membrane.rate_integral(problem.X, fabric.membrane, loads)]
    if problem.bending:
        parts += problem.bending.rate_integrals(problem.X, fabric.bending)
    return Assembled(parts).residual(x)


def _seam_forces(state: RelaxationState, number: ChangingNumber, fabric: FabricRates) -> np.ndarray:
    """Rates (n, 3) of the forces of seams, linear in their stiffness: one given, or decided from the membrane's."""
    problem, rates = state.problem, np.zeros(len(state.problem.seams.stiffness))
    slack = np.zeros_like(rates)
    strongest = int(np.argmax(np.broadcast_to(problem.fabric.membrane, fabric.membrane.shape)))
    decided = float(fabric.membrane.reshape(-1)[strongest]) / problem.stiffest
    for name, own in problem.seams.springs_by_name():
        given = state.scene.seams[name].stiffness is not None
        rates[own] = number.rate(1.0, f"seams.{name}.stiffness") if given else decided * problem.seams.stiffness[own]
        slack[own] = number.rate(1.0, f"seams.{name}.slack")
    parts = [problem.seams.integral(0, rates)]
    if slack.any():
        parts += problem.seams.slack_rate_integrals(slack, problem.corners(state.x))
    if problem.seam_bending:
        changes = problem.seam_bending.stiffness_of(fabric.bending, problem.fabric)
        parts.append(problem.seam_bending.integral(0, changes))
    return Assembled(parts).residual(state.x)


# --- contact ---------------------------------------------------------------------------------------------------------


def _contact_change(state: RelaxationState, number: ChangingNumber) -> ContactChange:
    """Rates of the numbers of contact and of bodies."""
    settings, where = state.plan.settings("contact"), "effects.contact"
    thickness = number.dual(settings.thickness, f"{where}.thickness")
    given = state.scene.effects.get("contact", {}).get("stiffness") is not None or number.key == f"{where}.stiffness"
    stiffness = (
        number.dual(settings.stiffness, f"{where}.stiffness") if given else _decided_stiffness(state, number, thickness)
    )
    changing = {}
    for k, (name, body) in enumerate(state.scene.bodies.items()):
        rates, friction = number.form(name, body), number.rate(body.friction, f"bodies.{name}.friction")
        if friction or any(np.any(rate) for rate in rates.values()):
            own = state.bodies[k]
            changing[k] = BodyChange(_kernel_rates(own, rates), friction, partial(taken_rates, own, rates))
    return ContactChange(
        float(stiffness.rate),
        float(thickness.rate),
        number.rate(settings.slip, f"{where}.slip"),
        changing,
    )


def _decided_stiffness(state: RelaxationState, number: ChangingNumber, thickness: Dual) -> Dual:
    """The stiffness of contact that `effects.contact` decides from the weight of the cloth."""
    scene = state.scene
    weights = [_weight(state, number, name) for name in scene.material]
    bodies = {name: number.dual_body(name, body) for name, body in scene.bodies.items()}
    # What has no edges has ones of infinite radius, which never decide.
    with np.errstate(invalid="ignore"):
        times = dual(borne(scene, thickness, bodies)[0])
    return 8.0 * times * max(weights) / thickness


def _weight(state: RelaxationState, number: ChangingNumber, name: str) -> Dual:
    """What a material weighs by area [N/m^2]."""
    material, gravity, where = state.scene.material[name], state.plan.settings("gravity"), f"material.{name}"
    g = [number.dual(value, f"effects.gravity.g.{k}") for k, value in enumerate(gravity.g)]
    size = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) ** 0.5
    return size * number.dual(material.rho, f"{where}.rho") * number.dual(material.thickness, f"{where}.thickness")


def _kernel_rates(body: Body, rates: dict) -> _kernels.BodyRates:
    """The body, of numbers alone, with rates of the keys of its form."""
    form, make = body.form, _kernels.BodyRates
    match body.kind:
        case "sphere":
            return make.sphere(form.center, form.radius, rates["center"], rates["radius"])
        case "plane":
            return make.plane(form.point, form.normal, rates["point"], rates["normal"])
        case "capsule":
            return make.capsule(form.start, form.end, form.radius, rates["start"], rates["end"], rates["radius"])
        case "cylinder":
            ends = form.start, form.end, form.radius, form.rounded
            return make.cylinder(*ends, rates["start"], rates["end"], rates["radius"], rates["rounded"])
        case "mesh" | "mannequin":
            turn, turned = rotation(form.turn).T, rotation_rates(form.turn, rates["turn"]).T
            numbers = form.move, turn, form.scale, rates["move"], turned, rates["scale"]
            return make.mesh(distance_of(form).grid, *numbers)
        case _:
            turn, turned = rotation(form.rotate).T, rotation_rates(form.rotate, rates["rotate"]).T
            numbers = form.center, form.half, turn, form.radius
            return make.box(*numbers, rates["center"], rates["half"], turned, rates["radius"])


def _layer_forces(
    state: RelaxationState, layers: AgreedLayers | None, number: ChangingNumber, fabric: FabricRates
) -> np.ndarray:
    """Rates (n, 3) of the forces between layers, whose stiffness is decided from weight or bending.

    Args:
        layers: that friction holds; None: there is none. Others as of `scene_rates`.

    Raises:
        UserError: the distance at which they begin changes.
    """
    problem = state.problem
    own, corners, out = problem.self_contact, problem.corners(state.x), np.zeros_like(state.x)
    share = stiffness_share(
        problem.self_contact.values.thickness, problem.fabric, problem.g, fabric, _gravity_rate(state, number)
    )
    if share:
        out[problem.corner_number] = share * own.barrier_forces(corners)
    settings, where = state.plan.settings("contact"), "effects.contact"
    if layers and settings:
        rough = number.rate(settings.self_friction, f"{where}.self_friction")
        out += layers.number_rates(share * own.values.stiffness, rough, number.rate(settings.slip, f"{where}.slip"))
    if number.key == "effects.contact.thickness" and own.at(corners).near:
        raise UserError(
            "layers touch, and drapes have no derivative by the distance at which their contact begins",
            "--by",
            "name another number, or set effects.contact.self_thickness",
        )
    return out


# --- supports --------------------------------------------------------------------------------------------------------


def _support_rates(state: RelaxationState, number: ChangingNumber) -> tuple[np.ndarray, np.ndarray]:
    """Rates (n, 3) [m] of the prescribed unknowns, and (3,) of how directions of clamps turn [rad]."""
    scene, problem = state.scene, state.problem
    mesh, mask = problem.mesh, problem.supports.mask
    start, rates = evaluated(scene.start or Start(), scene.parameters), number.start()
    turned = rotation_rates(start.turn, rates["turn"])
    # Panels where they lie by themselves.
    own = InitialPlacement(scene.model_copy(update={"start": None}))
    flat, coordinates = own.places(mesh) - start.about, own.coordinates(mesh)
    turn = rotation(start.turn)
    placed = flat @ turned.T + rates["about"] - rates["about"] @ turn.T + rates["move"]
    places = placed.copy()
    for name, support in scene.supports.items():
        nodes = nodes_on(mesh, support.on)
        for direction, value in support.fix.items():
            if direction != "slope":
                axis, where = AXES.index(direction), f"supports.{name}.fix.{direction}"
                places[nodes, axis] = placed[nodes, axis] + number.rates(value, where, coordinates[nodes])
    places[problem.supports.hand] = 0.0
    out = np.zeros((problem.n_nodes, 3))
    out[problem.corner_number] = np.where(mask, places, 0.0)
    if problem.morley:
        clamped = problem.supports.clamped
        slopes = own.directions(mesh, mesh.edge_nodes[clamped, 0], problem.morley.normals()[clamped])
        out[problem.morley.side_number[clamped]] = slopes @ turned.T
    spin = turned @ turn.T
    return out, np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
