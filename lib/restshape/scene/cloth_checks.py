"""What scenes of cloth may hold that others may not, and what they may not hold."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from restshape.application import Application
from restshape.scene.bodies import settled
from restshape.scene.model import Scene
from restshape.scene.source import Source
from restshape.scene.units import UnitError

ENERGIES = ("strain", "membrane", "bending", "potential")
"""Energies that cloth has; others than the first are its own."""

KINDS = ("displacement", "reaction", "energy", "area")
"""Kinds of quantities that cloth has."""

Key = tuple[str, ...]


def formulas_of_bodies(scene: Scene) -> list[tuple[Key, Any]]:
    """Keys and values of all that is a number, or a formula of the parameters, of ``[bodies]`` and ``[start]``."""
    found: list[tuple[Key, Any]] = []
    for name, body in scene.bodies.items():
        form = body.form
        given = [((body.kind, key), getattr(form, key)) for key in type(form).model_fields]
        for key, value in [*given, (("friction",), body.friction)]:
            found += [(("bodies", name, *key), one) for one in (value if isinstance(value, tuple) else (value,))]
    if scene.start is not None:
        found += [(("start", key), one) for key in ("move", "turn", "about") for one in getattr(scene.start, key)]
    return found


def check_cloth(scene: Scene, application: Application, source: Source) -> None:
    """Checks bodies and what else is of cloth; refuses it where the application knows none.

    Raises:
        UserError: the first thing that makes no sense.
    """
    if not application.cloth:
        for key in _of_cloth(scene):
            what = f"the application {application.name!r} knows nothing of cloth: {'.'.join(key)} has no meaning in it"
            raise source.error(key, what, 'leave it out, or use app = "couture"')
        return
    for key, what, do in _not_of_cloth(scene):
        raise source.error(key, f"cloth has {what}", do)
    _check_bodies(scene, source)
    for name, material in scene.material.items():
        if "thickness" not in material.model_fields_set:
            raise source.error(("material", name), "the cloth has no thickness", 'add thickness = "0.3 mm"')


def _of_cloth(scene: Scene) -> Iterator[Key]:
    """Keys of a scene that mean something for cloth only."""
    yield from (("bodies", name) for name in scene.bodies)
    if scene.start is not None:
        yield ("start",)
    yield from (("material", name, "bending") for name, m in scene.material.items() if m.bending is not None)
    yield from (("supports", name, "symmetry") for name, s in scene.supports.items() if s.symmetry is not None)
    for name, quantity in scene.quantities.items():
        yield from (("quantities", name, kind) for kind in KINDS[:2] if getattr(quantity, kind) == "z")
        if quantity.energy in ENERGIES[1:]:
            yield ("quantities", name, "energy")


def _not_of_cloth(scene: Scene) -> Iterator[tuple[Key, str, str]]:
    """Keys of a scene that mean nothing for cloth, with what it is that cloth has not, and what to do."""
    for name in scene.loads:
        yield ("loads", name), "no loads but its weight and what touches it", "use [effects.gravity] and [bodies.NAME]"
    for name, quantity in scene.quantities.items():
        if quantity.kind not in KINDS:
            yield ("quantities", name), f"no {quantity.kind}", f"use one of: {', '.join(KINDS)}"
        if quantity.energy is not None and quantity.energy not in ENERGIES:
            do = f"use one of: {', '.join(ENERGIES)}"
            yield ("quantities", name, "energy"), f"no energy {quantity.energy!r}", do


def _check_bodies(scene: Scene, source: Source) -> None:
    """Refuses bodies without a size, names that stand for two things, and a start that is no place."""
    entities = scene.shape.kinds()
    for name in scene.bodies:
        if name in entities:
            what = f"the name {name!r} stands for a body and for a part of the shape, which is {entities[name]!r}"
            raise source.error(("bodies", name), what, "rename one of the two")
    whole = [(("bodies", name), body.settled) for name, body in scene.bodies.items()]
    whole += [] if scene.start is None else [(("start",), partial(settled, scene.start))]
    for key, settle in whole:
        try:
            settle(scene.parameters)
        except UnitError as error:
            what, _, do = str(error).partition(": ")
            raise source.error(key, what, do) from error
