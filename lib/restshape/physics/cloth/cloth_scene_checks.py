"""What models alone cannot check in a scene of cloth."""

from __future__ import annotations

from functools import partial
from typing import Any

from restshape.errors import UserError
from restshape.physics.cloth.seams.seam_checks import check_seams
from restshape.scene.bodies import numbers_of
from restshape.scene.checks import check_file, refuse_places
from restshape.scene.expressions import Expression
from restshape.scene.model import Scene
from restshape.scene.panels import panels_of
from restshape.scene.pattern_packing import bounds
from restshape.scene.source import Source, split_key, suggestion
from restshape.scene.space_values import evaluated
from restshape.scene.units import UnitError
from restshape.shape.panels.panel_placement import PatternPlacement

Key = tuple[str, ...]
LARGE, UNLIKE = 10.0, 30.0
"""Length of a panel [m], and that over another panel's, above which they have unlike units."""


def formulas_of_bodies(scene: Scene) -> list[tuple[Key, Any]]:
    """Keys and values of all that is a number, or a formula of the parameters, of bodies, panels and ``[start]``."""
    found: list[tuple[Key, Any]] = []
    for name, body in scene.bodies.items():
        form = body.form
        given = [((body.kind, key), getattr(form, key)) for key in numbers_of(form)]
        for key, value in [*given, (("friction",), body.friction)]:
            found += [(("bodies", name, *key), one) for one in (value if isinstance(value, tuple) else (value,))]
    for name, panel in panels_of(scene).items():
        found += [(("panels", name, key), one) for key in ("move", "turn", "about") for one in getattr(panel, key)]
    if scene.start is not None:
        found += [(("start", key), one) for key in ("move", "turn", "about") for one in getattr(scene.start, key)]
    return found


def check_cloth(scene: Scene, source: Source) -> None:
    """Checks bodies, where the cloth starts, its thickness, and what quantities are taken over.

    Raises:
        UserError: the first thing that makes no sense.
    """
    for place, value in formulas_of_bodies(scene):
        refuse_places(place, value, "a number of a body", source)
    _check_bodies(scene, source)
    _check_panels(scene, source)
    check_seams(scene, scene.shape.kinds(), source)
    for name, material in scene.material.items():
        if "thickness" not in material.model_fields_set:
            raise source.error(("material", name), "the cloth has no thickness", 'add thickness = "0.3 mm"')
        if isinstance(material.thickness, Expression):
            what = f"the application {scene.app!r} knows one thickness a material only"
            raise source.error(("material", name, "thickness"), what, "give a number")
    for name, quantity in scene.quantities.items():
        if quantity.at is not None and (quantity.energy or quantity.folds):
            what = f"{'energies' if quantity.energy else 'folds'} of cloth are those of all of it"
            raise source.error(("quantities", name, "at"), what, "leave it out")


def _check_panels(scene: Scene, source: Source) -> None:
    """Refuses panels of a material, or around a body, that is not there, and places that are none."""
    for name, panel in panels_of(scene).items():
        for key, known in (("material", scene.material), ("around", scene.bodies)):
            wanted = getattr(panel, key)
            if wanted is not None and wanted not in known:
                kind = "material" if key == "material" else "body"
                raise source.error(
                    ("panels", name, key), f"there is no {kind} {wanted!r}", suggestion(wanted, list(known))
                )
    _refuse_unlike_units(scene, source)
    layered = [name for name, panel in panels_of(scene).items() if panel.layer is not None]
    if layered and scene.effects.get("contact", {}).get("self") is False:
        what = "layers have an order, and self = false lets them pass through each other"
        raise source.error(("panels", layered[0], "layer"), what, "take out layer, or self = false")
    if panels_of(scene):
        try:
            PatternPlacement(scene)
        except UserError as error:
            raise source.error(split_key(error.where), error.what, error.do) from error
        except UnitError as error:
            raise source.error(("panels",), error.what, error.do) from error


def _refuse_unlike_units(scene: Scene, source: Source) -> None:
    """Refuses a panel of tens of metres beside one that is as small as if it had another unit of length."""
    boxes = {name: bounds(panel, 0.0) for name, panel in panels_of(scene).items()}
    sizes = {name: max(box.x1 - box.x0, box.y1 - box.y0) for name, box in boxes.items()}
    if len(sizes) < 2:
        return
    largest, least = max(sizes, key=lambda name: sizes[name]), min(sizes, key=lambda name: sizes[name])
    if sizes[largest] > LARGE and sizes[largest] > UNLIKE * sizes[least]:
        what = f"it is {sizes[largest]:.3g} m long, and panel {least} {sizes[least]:.3g} m: their units are unlike"
        raise source.error(
            ("panels", largest), what, 'give its lengths a unit, such as "40 cm"; bare numbers are metres'
        )


def _check_bodies(scene: Scene, source: Source) -> None:
    """Refuses bodies without a size, names that stand for two things, and a start that is no place."""
    entities = scene.shape.kinds()
    for name, body in scene.bodies.items():
        if body.mesh is not None:
            check_file(("bodies", name, "mesh", "file"), body.mesh.file, source)
        if name in entities:
            what = f"the name {name!r} stands for a body and for a part of the shape, which is {entities[name]!r}"
            raise source.error(("bodies", name), what, "rename one of the two")
    whole = [(("bodies", name), body.evaluated) for name, body in scene.bodies.items()]
    whole += [] if scene.start is None else [(("start",), partial(evaluated, scene.start))]
    for key, settle in whole:
        try:
            settle(scene.parameters)
        except UnitError as error:
            raise source.error(key, error.what, error.do) from error
