"""What a scene of cloth says about a sheet on one mesh: stiffness, mass, supports, bodies, and where it starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.supports import supports
from restshape.physics.cloth.contact import Contact
from restshape.physics.cloth.fabric import fabric
from restshape.physics.cloth.initial_placement import Laid, rotation
from restshape.physics.cloth.sheet import Fabric, Held, Sheet
from restshape.scene.bodies import Body
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


@dataclass(frozen=True)
class SheetArguments:
    """What a sheet is made from.

    Args:
        fabric: stiffness and mass; one matrix and one number where all cells agree.
        held: supports.
        g: (3,) acceleration [m/s^2].
        bodies: each with its coefficient of friction, in the scene's order.
        contact: settings of the effect; None: nothing touches, and there are no bodies.
        start: (n, 3) where nodes lie at first [m].
    """

    fabric: Fabric
    held: Held
    g: np.ndarray
    bodies: list[tuple[_kernels.Body, float]]
    contact: Any
    start: np.ndarray


def sheet_arguments(scene: Scene, plan: Plan, mesh: Mesh) -> SheetArguments:
    """What a scene says about its cloth on a mesh.

    Raises:
        UserError: a part has no material, supports clash, a slope or a plane of symmetry is on no edge.
    """
    gravity = plan.settings("gravity")
    contact = plan.settings("contact")
    laid = Laid(scene.start, scene.parameters)
    held = supports(scene, mesh, laid)
    return SheetArguments(
        fabric=fabric(scene, plan, mesh),
        held=held,
        g=np.array(gravity.g if gravity else (0.0, 0.0, 0.0)),
        bodies=[] if contact is None else touched(scene),
        contact=contact,
        start=np.where(held.mask, held.places, laid.scattered(mesh)),
    )


def sheet_of(mesh: Mesh, arguments: SheetArguments) -> Sheet:
    """The sheet of a scene on a mesh."""
    sheet = Sheet(mesh, arguments.fabric, arguments.held, arguments.g)
    if arguments.bodies:
        settings = arguments.contact
        sheet.contact = Contact(
            [body for body, _ in arguments.bodies],
            sheet.area[sheet.number],
            settings.stiffness,
            settings.thickness,
            [friction for _, friction in arguments.bodies],
            settings.slip,
        )
    return sheet


def set_contact(sheet: Sheet, arguments: SheetArguments) -> None:
    """Let contact be with bodies, and of values, that are others; friction remembers what it did."""
    contact, settings = sheet.contact, arguments.contact
    contact.bodies = [body for body, _ in arguments.bodies]
    contact.friction = np.array([friction for _, friction in arguments.bodies])
    contact.area = sheet.area[sheet.number]
    contact.stiffness, contact.thickness, contact.slip = settings.stiffness, settings.thickness, settings.slip


def touched(scene: Scene) -> list[tuple[_kernels.Body, float]]:
    """The scene's bodies where they are now, each with its coefficient of friction."""
    bodies = [body.settled(scene.parameters) for body in scene.bodies.values()]
    return [(kernel_body(body), body.friction) for body in bodies]


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
        case _:
            # Its axes are the rows.
            return _kernels.Body.box(form.center, form.half, rotation(form.rotate).T, form.radius)
