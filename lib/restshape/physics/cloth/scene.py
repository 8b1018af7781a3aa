"""What a scene says about its cloth on one mesh: stiffness, mass, supports, bodies, and where it starts."""

# More than 15 modules: what each part of cloth is made from comes from a module of its own.

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.cloth_supports import supports_of
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.contact.mesh_bodies import kernel_mesh, located_distance, refuse_narrow
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.seams.seam_lines import SeamPair, seam_pairs
from restshape.physics.cloth.seams.seams import Seams
from restshape.physics.cloth.self_contact.layer_order import LayerOrder
from restshape.physics.cloth.self_contact.layers import layer_values
from restshape.physics.cloth.self_contact.self_contact import SelfContact, SelfContactValues
from restshape.physics.cloth.sheet.cloth_boundary import ClothSupports
from restshape.physics.cloth.sheet.cloth_materials import fabric_of
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.parameters import triangle_areas
from restshape.scene.bodies import Body
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.shape.placement import rotation


@dataclass(frozen=True)
class ClothArguments:
    """What the problem of cloth is made from.

    Args:
        fabric: stiffness and mass; one matrix and one number where all cells agree.
        supports: on this mesh.
        g: (3,) acceleration [m/s^2].
        bodies: each with its coefficient of friction, in the scene's order; forms: the same as numbers alone.
        contact: settings of the effect; None: nothing touches, and there are no bodies.
        placed: (n, 3) where nodes lie at first [m], before supports take them; start: with these.
        layers: how parts of the cloth push each other away; None: they pass through each other.
        seams: what is sewn together.
        order: which panels lie outside of which; None: the scene has no layers.
    """

    fabric: Fabric
    supports: ClothSupports
    g: np.ndarray
    bodies: list[tuple[_kernels.Body, float]]
    contact: Any
    placed: np.ndarray
    start: np.ndarray
    layers: SelfContactValues | None = None
    seams: tuple[SeamPair, ...] = ()
    order: LayerOrder | None = None
    forms: tuple[Body, ...] = ()


def cloth_arguments(scene: Scene, plan: Plan, mesh: Mesh, hand: np.ndarray | None = None) -> ClothArguments:
    """What a scene says about its cloth on a mesh.

    Args:
        scene: with its plan; mesh: of the cloth.
        hand: the node (1,) that a hand holds; None: the one that is nearest to its point now.

    Raises:
        UserError: a part has no material, supports clash, a slope or a plane of symmetry is on no edge.
    """
    gravity = plan.settings("gravity")
    contact = plan.settings("contact")
    if contact is not None:
        refuse_narrow(scene, contact.thickness)
    placement = InitialPlacement(scene)
    fabric = fabric_of(scene, plan, mesh)
    supports, placed = supports_of(scene, mesh, placement, hand), placement.scattered(mesh)
    forms = () if contact is None else forms_of(scene)
    bodies = [(kernel_body(body), body.friction) for body in forms]
    return ClothArguments(
        fabric=fabric,
        supports=supports,
        g=np.array(gravity.g if gravity else (0.0, 0.0, 0.0)),
        bodies=bodies,
        contact=contact,
        placed=placed,
        start=np.where(supports.mask, supports.places, placed),
        layers=layer_values(scene, plan, mesh, fabric),
        seams=seam_pairs(scene, mesh, placed, float(fabric.membrane.max())),
        order=LayerOrder.of(scene, mesh, placed, [body for body, _ in bodies]),
        forms=forms,
    )


def cloth_problem(mesh: Mesh, arguments: ClothArguments) -> ClothProblem:
    """The problem of a scene's cloth on a mesh."""
    problem = ClothProblem(mesh, arguments.fabric, arguments.supports, arguments.g)
    problem.order = arguments.order
    if arguments.seams:
        problem.sew(Seams(arguments.seams, problem.corner_number))
    if arguments.layers:
        problem.self_contact = SelfContact(problem.surface, arguments.layers)
    if arguments.bodies:
        settings = arguments.contact
        problem.contact = Contact(
            [body for body, _ in arguments.bodies],
            problem.lumped.area[problem.corner_number],
            settings.stiffness,
            settings.thickness,
            [friction for _, friction in arguments.bodies],
            settings.slip,
            mesh.cells,
            triangle_areas(problem.X, problem.membrane.corners),
        )
    return problem


def set_values(problem: ClothProblem, arguments: ClothArguments) -> None:
    """Let fabric, supports, acceleration and seams be others, of the same kinds, and the mesh as it lies now."""
    if problem.seams:
        problem.seams.pairs = arguments.seams
    problem.order = arguments.order
    problem.set_values(arguments.fabric, arguments.supports, arguments.g)


def set_contact(problem: ClothProblem, arguments: ClothArguments) -> None:
    """Let contact be with bodies, and of values, that are others; friction remembers what it did."""
    if problem.self_contact and problem.self_contact.values != arguments.layers:
        problem.self_contact.set_values(arguments.layers)
    if not problem.contact:
        return
    contact, settings = problem.contact, arguments.contact
    contact.bodies = [body for body, _ in arguments.bodies]
    contact.friction = np.array([friction for _, friction in arguments.bodies])
    contact.area, contact.cell_area = (
        problem.lumped.area[problem.corner_number],
        triangle_areas(problem.X, problem.membrane.corners),
    )
    contact.stiffness, contact.thickness, contact.slip = settings.stiffness, settings.thickness, settings.slip


def forms_of(scene: Scene) -> tuple[Body, ...]:
    """The scene's bodies where they are now, of numbers alone."""
    for name, body in scene.bodies.items():
        if body.form_on_grid:
            located_distance(scene, name)
    return tuple(body.evaluated(scene.parameters) for body in scene.bodies.values())


def kernel_body(body: Body) -> _kernels.Body:
    """The body, of numbers alone, as the kernels take it."""
    form = body.form
    match body.kind:
        case "sphere":
            return _kernels.Body.sphere(form.center, form.radius)
        case "plane":
            return _kernels.Body.plane(form.point, form.normal)
        case "capsule":
            return _kernels.Body.capsule(form.start, form.end, form.radius)
        case "cylinder":
            return _kernels.Body.cylinder(form.start, form.end, form.radius, form.rounded)
        case "mesh" | "mannequin":
            return kernel_mesh(form)
        case _:
            # Its axes are the rows.
            return _kernels.Body.box(form.center, form.half, rotation(form.rotate).T, form.radius)
