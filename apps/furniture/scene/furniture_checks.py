"""What scenes of furniture may hold that others may not, and what they may not hold."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from restshape_apps.furniture.scene.furniture import BESIDE
from restshape_apps.furniture.scene.plank_quantities import check_plank_quantities

from restshape.scene.expressions import COORDINATES, Expression
from restshape.scene.model import Scene
from restshape.scene.source import Source, suggestion
from restshape.scene.space_values import number
from restshape.scene.units import UnitError

TABLES = ("wood", "fastener", "planks", "joints", "floor", "weights", "pushes")
"""Tables that only scenes of furniture have."""

OTHERS = ("shape", "material", "supports", "loads", "bodies", "start", "goal", "mesh")
"""Tables that scenes of furniture do not have."""

Key = tuple[str, ...]


def check_furniture(scene: Scene, source: Source) -> None:
    """Checks the tables of a piece of furniture: names that refer to each other, numbers, sense.

    Raises:
        UserError: the first thing that makes no sense.
    """
    for key in OTHERS:
        if key in scene.model_fields_set:
            do = f"leave it out; a piece of furniture is described by {', '.join(TABLES)}"
            raise source.error((key,), f"furniture is made of planks: {key} has no meaning in it", do)
    if not scene.planks:
        raise source.error(("planks",), "the piece has no planks", "add [planks.NAME]")
    for key, name in _references(scene):
        if name not in scene.planks:
            raise source.error(key, f"there is no plank {name!r}", suggestion(name, sorted(scene.planks)))
    for key, value in _numbers(scene):
        _check_number(scene, source, key, value)
    for table in ("weights", "pushes"):
        for name, load in getattr(scene, table).items():
            if load.at is not None and max(map(abs, load.at)) > 0.5:
                what = f"the place {list(load.at)} is beside the plank {load.on}"
                raise source.error((table, name, "at"), what, BESIDE)
    check_plank_quantities(scene, source)
    for name, joint in scene.joints.named.items():
        if joint.plank == joint.to:
            raise source.error(("joints", name, "to"), "a plank cannot be joined to itself", "name another one")
    taken = set(scene.planks)
    for table in ("weights", "pushes"):
        for name in getattr(scene, table):
            if name in taken:
                raise source.error((table, name), f"the name {name!r} is used twice", "rename one of the two")
            taken.add(name)


def _references(scene: Scene) -> Iterator[tuple[Key, str]]:
    """Keys that name planks, with the names."""
    for table in ("weights", "pushes"):
        yield from (((table, name, "on"), load.on) for name, load in getattr(scene, table).items())
    for name, joint in scene.joints.named.items():
        yield ("joints", name, "plank"), joint.plank
        yield ("joints", name, "to"), joint.to


def _numbers(scene: Scene) -> Iterator[tuple[Key, Any]]:
    """Keys of all that is a number, or a formula of the parameters."""
    yield ("wood", "thickness"), scene.wood.thickness
    for name, plank in scene.planks.items():
        for key in ("start", "to", "width", "center", "size", "turn"):
            values = getattr(plank, key) or ()
            yield from ((("planks", name, "from" if key == "start" else key), one) for one in values)
        if plank.thickness is not None:
            yield ("planks", name, "thickness"), plank.thickness
    yield from ((("weights", name, "mass"), load.mass) for name, load in scene.weights.items())
    for name, push in scene.pushes.items():
        yield from ((("pushes", name, "force"), one) for one in push.force)


POSITIVE = ("thickness", "size", "mass")


def _check_number(scene: Scene, source: Source, key: Key, value: Any) -> None:
    """Refuses formulas of what is not known, and sizes that are none."""
    if isinstance(value, Expression):
        if value.names.intersection(COORDINATES):
            what = "a plank has no coordinates of its own: this formula cannot name x or y"
            raise source.error(key, what, "use [parameters] only")
        if unknown := value.unknown(scene.parameters, ()):
            raise source.error(key, unknown.what, unknown.do)
    try:
        found = number(value, scene.parameters)
    except UnitError as error:
        raise source.error(key, error.what, error.do) from error
    if key[-1] in POSITIVE and found <= 0.0:
        raise source.error(key, f"{found:g} is too small: it must be greater than 0", "give a number above 0")
