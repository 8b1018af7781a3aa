"""Parts of the physics that follow from a scene without being named among its effects."""

from collections.abc import Callable

from restshape.scene.effect import DerivedEffect
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table, table_in, tables_in

On = frozenset[str]


def listed(table: str, names: list[str]) -> str:
    """Keys of a table of the scene, for people; empty where there are none."""
    return ", ".join(f"{table}.{name}" for name in names)


def loads_of(scene: Scene, kinds: tuple[str, ...]) -> str:
    """Keys of the loads of some kinds, for people; empty where there are none."""
    return listed("loads", [name for name, load in scene.loads.items() if load.kind in kinds])


def without_loads(raw: Table, kinds: tuple[str, ...]) -> Table:
    """The plain tables of a scene without its loads of some kinds."""
    loads = {name: load for name, load in tables_in(raw, "loads").items() if not set(kinds) & set(load)}
    return {**raw, "loads": loads}


def _moved(scene: Scene) -> list[str]:
    """Supports that prescribe a displacement."""
    return [name for name, support in scene.supports.items() if any(value != 0 for value in support.fix.values())]


def _at_zero(raw: Table, _: On) -> Table:
    # A list of directions is at 0 already.
    supports = {
        name: {**support, "fix": dict.fromkeys(fixed, 0.0)} if (fixed := table_in(support, "fix")) else support
        for name, support in tables_in(raw, "supports").items()
    }
    return {**raw, "supports": supports}


def _regions(scene: Scene, _: On) -> str:
    names = [name for name, material in scene.material.items() if material.region]
    return f"{listed('material', names)} fill regions: each cell has its own material" if names else ""


def _one_material(raw: Table, _: On) -> Table:
    """The material outside of regions everywhere; where there is none, the first one."""
    materials = tables_in(raw, "material")
    rest = next((name for name, material in materials.items() if "region" not in material), next(iter(materials)))
    alone = {key: value for key, value in materials[rest].items() if key != "region"}
    return {**raw, "material": {rest: alone}}


def cause_of(names: Callable[[Scene, On], str], what: str) -> Callable[[Scene, On], str]:
    """Why a scene calls for a part: the keys that do, and what they make of it; empty where there are none."""

    def cause(scene: Scene, on: On) -> str:
        found = names(scene, on)
        return f"{found}: {what}" if found else ""

    return cause


MOVING_SUPPORTS = DerivedEffect(
    "supports that displace what they hold",
    cause_of(lambda scene, _: listed("supports", _moved(scene)), "they displace what they hold"),
    "no support prescribes a displacement",
    _at_zero,
    drives=True,
)
REGIONS = DerivedEffect("materials of regions", _regions, "one material fills the shape", _one_material)
