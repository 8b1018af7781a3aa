"""What an outline shows of an elastic body before it has a mesh: whether it is constrained, and has a thickness."""

from collections.abc import Sequence

import numpy as np

from restshape.errors import ReplayProblem, UserError
from restshape.fem.dirichlet import Dirichlet, Prescribed
from restshape.mesh.entity_area import entity_area
from restshape.mesh.regions import contains, loop_polygon
from restshape.mesh.thickness import Thickness
from restshape.physics.elasticity.body_load import require_density
from restshape.physics.elasticity.modal_effect import modal_keys
from restshape.physics.elasticity.rigid_body_modes import check_rigid_body_modes
from restshape.physics.elasticity.vibrating_materials import common_thickness, constant_thickness, require_mass
from restshape.scene.expressions import Expression
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

REST = 1e-9
"""Share of the shape that regions leave, below which they fill it: the material of the rest is never looked at."""
GRID = 60
"""Places in each direction at which a thickness is looked at."""


def check_plane_solid(scene: Scene, outline: Outline) -> None:
    """Makes sure that supports hold the body and agree, as far as the outline shows, and that gravity has a mass.

    Raises:
        UserError: they leave it free to move, or disagree at a place, or a material has no density.
    """
    check_supports(scene, outline)
    _check_agreement(scene, outline)
    pull = scene.effects.get("gravity", {}).get("g")
    try:
        require_density(scene, None if pull is None else np.array(pull))
    except UserError as error:
        raise scene.located(error) from error


def check_moving_solid(scene: Scene, outline: Outline) -> None:
    """As of `check_plane_solid`, and that each material of a body in motion that fills some of it has a density.

    Raises:
        UserError: one has none, or supports make no sense.
    """
    check_plane_solid(scene, outline)
    named = [region for material in scene.material.values() for region in material.region or ()]
    rest = entity_area(outline) - sum(entity_area(outline, region) for region in named)
    for name, material in scene.material.items():
        if not material.rho and (material.region or rest > REST * entity_area(outline)):
            do = 'give it one, e.g. rho = "2400 kg/m^3"'
            raise scene.located(UserError("a body without density cannot vibrate", f"material.{name}", do))


def check_supports(scene: Scene, outline: Outline) -> None:
    """Makes sure that the supports hold the body, as far as the outline shows.

    Raises:
        UserError: they leave it free to move.
    """
    points, masks = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for support in scene.supports.values():
        found = _places(outline, support.on)
        points.append(found)
        masks.append(np.tile([axis in support.fix for axis in "xy"], (len(found), 1)))
    body = np.concatenate([outline.points, *points])
    check_rigid_body_modes(body, np.concatenate([np.zeros_like(outline.points), *masks]), scene)


def _places(outline: Outline, names: Sequence[str]) -> np.ndarray:
    """Places (k, 2) [m] of entities: vertices, and points along edges and around loops."""
    found = [np.zeros((0, 2))]
    for entity in map(outline.entity, names):
        edges = {*entity.edges, *(edge for loop in entity.loops for edge, _ in outline.loops[loop].edges)}
        found += [outline.points[list(entity.vertices)], *map(outline.polyline, edges)]
    return np.concatenate(found)


def _check_agreement(scene: Scene, outline: Outline) -> None:
    """Refuses supports that prescribe different values where they meet on the outline, as the first frame does.

    Raises:
        UserError: two of them do; or a formula has no number there.
    """
    places = [_places(outline, support.on) for support in scene.supports.values()]
    if not sum(map(len, places)):
        return
    points, numbers = np.unique(np.concatenate(places), axis=0, return_inverse=True)
    nodes = np.split(numbers.ravel(), np.cumsum([len(found) for found in places])[:-1])
    conditions = [
        Prescribed(f"supports.{name}.fix.{axis}", "xy".index(axis), own, value)
        for (name, support), own in zip(scene.supports.items(), map(np.unique, nodes))
        for axis, value in support.fix.items()
    ]
    try:
        Dirichlet((len(points), 2), conditions, scene.parameters, "m").evaluate(points)
    except UserError as error:
        raise scene.located(error) from error
    except ReplayProblem as problem:
        raise scene.located(UserError(str(problem), "supports", "change the formula")) from problem


def check_vibrating(scene: Scene, outline: Outline) -> None:
    """Makes sure that the materials of a body that vibrates freely have a mass, and a thickness that its model takes.

    Raises:
        UserError: they have not.
    """
    try:
        require_mass(scene)
        if modal_keys(scene).model in ("solid", "plate"):
            common_thickness(scene)
        else:
            for material in scene.material.values():
                constant_thickness(material)
    except UserError as error:
        raise scene.located(error) from error
    check_thickness(scene, outline)


def check_thickness(scene: Scene, outline: Outline) -> None:
    """Makes sure that thicknesses given by formulas are positive all over the outline.

    Raises:
        UserError: one is not, or is not a number, somewhere.
    """
    formulas = {name: m.thickness for name, m in scene.material.items() if isinstance(m.thickness, Expression)}
    if not formulas:
        return
    low, high = outline.bounds()
    axes = (np.linspace(a, b, GRID) for a, b in zip(low, high))
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    border = loop_polygon(outline, outline.loops[0])
    places = np.concatenate([border, places[contains(border, places)]])
    for name, formula in formulas.items():
        try:
            Thickness(formula, scene.parameters).at(places)
        except ReplayProblem as problem:
            do = "change the formula, so that the body has a thickness everywhere"
            raise scene.located(UserError(str(problem), f"material.{name}.thickness", do)) from problem
