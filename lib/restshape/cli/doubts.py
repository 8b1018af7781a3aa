"""What is odd in a scene of any physics, though it can be simulated: units left out, keys that have no effect."""

# More than 15 modules: each kind of doubt looks at another part of a scene.

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from restshape.application import application_of
from restshape.cli.bare_numbers import FULL_TURN, bare_numbers
from restshape.cli.relocation_word import relocation_word
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.curve_edges import curve_edges
from restshape.mesh.sizing import PER_CIRCLE
from restshape.replay.rounding import load_scales
from restshape.scene.bare_lengths import bare_lengths
from restshape.scene.edit_script import Script, Set
from restshape.scene.given_numbers import edited_number, given_numbers
from restshape.scene.load import revise
from restshape.scene.model import Material, Scene
from restshape.scene.plain_values import table_in
from restshape.scene.quantity import in_unit, limit_in_unit
from restshape.shape.drawings.imported_shape import imported_shape
from restshape.shape.outline import Outline

FAR_OFF = 1e-3
"""Share of the stress that loads give over the whole shape, below which a limit on stress is hardly meant."""
TOLERATED = 1.1
"""Edges of a curve that turn by less than this times what is usual are as usual."""

LENGTHS = ("displacement", "distance")
"""Quantities whose limits are hardly larger than the shape."""
EARTH, STRONG = 9.81, 10.0
"""Gravity of the earth [m/s^2], and the multiple of it from which on it is hardly meant."""
MOST_SETS = 50
"""Events `set` of a script that are looked at."""


def doubts(scene: Scene, outline: Outline) -> list[str]:
    """What a user may have meant otherwise, a line each, of a scene and its first outline."""
    return [
        *bare_lengths(scene),
        *_sizes(scene, _size(outline)),
        *_values(scene, outline),
        *_limits_in_time(scene),
        *_sums(scene, outline),
        *_mesh(scene, outline),
        *_drawing(scene, outline),
        *_curves(scene, outline),
    ]


def script_doubts(scene: Scene, outline: Outline, script: Script) -> list[str]:
    """What a user may have meant otherwise in values that a script sets, a line each, as if the scene had them.

    Numbers without a unit are in SI units whatever the script's header says.
    """
    known, found = set(_seen(scene, outline)), []
    for event in [one for one in script.events if isinstance(one, Set)][:MOST_SETS]:
        try:
            words = [*_seen(revise(scene, event.key, event.value), outline), *_followers(scene, event)]
        except (ReplayProblem, UserError):
            # The frame will say why it is refused.
            continue
        found += [f"line {event.line}: set {one}" for one in words if one not in known]
        known.update(words)
    return found


def _followers(scene: Scene, event: Set) -> Iterator[str]:
    """That a number is given by a parameter which gives others beside the shape too: all of them are set."""
    key = edited_number(scene, event.key, event.value)
    name = key.removeprefix("parameters.")
    if key == event.key or name == key or event.key.startswith("shape."):
        return
    given = [(".".join(one.key), one.formula.parameters) for one in given_numbers(scene)]
    others = [other for other, parameters in given if name in parameters and other != event.key]
    if others:
        more = f" and {len(others) - 2} more" if len(others) > 2 else ""
        what = f"{event.key} sets {key} and, with it, {', '.join(others[:2])}{more}"
        yield f"{what}; a number of its own in the scene is set alone"


def _seen(scene: Scene, outline: Outline) -> list[str]:
    """What is odd about values of a scene, also for its physics."""
    physics = application_of(scene).physics
    return [*_values(scene, outline), *(one for each in physics for one in each.inspected(scene, outline).warnings)]


def _values(scene: Scene, outline: Outline) -> list[str]:
    """What is odd about values of any scene."""
    size = _size(outline)
    return [
        *bare_numbers(scene, size),
        *_low_limits(scene, size),
        *_far_limits(scene, size),
        *_high_loads(scene, size),
        *_strong_gravity(scene),
        *(words for each in application_of(scene).physics for words in each.doubted(scene, outline)),
        *relocation_word(scene, outline),
    ]


def _size(outline: Outline) -> float:
    """The longer side of the box around a shape [m]."""
    return float(max(outline.bounds()[1] - outline.bounds()[0]))


def _sizes(scene: Scene, size: float) -> Iterator[str]:
    """Triangles that are wanted larger than the shape, in whatever unit they were written."""
    raw = table_in(scene.raw, "mesh")
    written = {"mesh.size": raw.get("size"), **{f"mesh.near.{k}": v for k, v in table_in(raw, "near").items()}}
    wanted = {"mesh.size": scene.mesh.size, **{f"mesh.near.{name}": near for name, near in scene.mesh.near.items()}}
    for key, length in wanted.items():
        # `bare_numbers` looks at those without a unit.
        if length is not None and length > size and isinstance(written.get(key), str):
            yield f"{key}: {length:g} m is more than the {size:.3g} m of the whole shape: is its unit right?"
    for name, length in scene.mesh.near.items():
        if scene.mesh.size is not None and scene.mesh.size < length <= size:
            yield (
                f"mesh.near.{name}: {length:g} m is more than mesh.size, {scene.mesh.size:g} m, and changes nothing: "
                "sizes near entities make the mesh finer there; raise mesh.size, and give all others a size"
            )


def _low_limits(scene: Scene, size: float) -> Iterator[str]:
    """Limits on stress far below what the loads give in a solid block of the shape's size."""
    usual = _usual_stress(scene, size)
    for name, quantity in scene.quantities.items():
        if quantity.unit == "Pa" and quantity.max is not None and 0.0 < quantity.max < FAR_OFF * usual:
            limit, nominal = limit_in_unit("Pa", quantity.max), in_unit("Pa", usual, 3)
            yield (
                f"quantities.{name}.max: {limit} is far below the {nominal} that the "
                'loads give over the whole shape: is its unit right? A number without one is in Pa: "190 MPa"'
            )


def _usual_stress(scene: Scene, size: float) -> float:
    """The stress [Pa] that the loads give in a solid block of the shape's size."""
    thick = [m.thickness for m in scene.material.values() if isinstance(getattr(m, "thickness", None), int | float)]
    loads = load_scales(scene)
    return max(loads.get("Pa", 0.0), loads.get("N", 0.0) / (max(thick) * size) if thick else 0.0)


def _far_limits(scene: Scene, size: float) -> Iterator[str]:
    """Limits without a unit on displacements and distances that are larger than the shape."""
    written = table_in(scene.raw, "quantities")
    for name, quantity in scene.quantities.items():
        for key in ("min", "max") if quantity.kind in LENGTHS else ():
            limit = table_in(written, name).get(key)
            if isinstance(limit, int | float) and abs(limit) > size:
                yield (
                    f"quantities.{name}.{key}: a limit without a unit is in metres, and {limit:g} m is more than the "
                    f'{size:.3g} m of the whole shape: "{limit:g} mm" or "{limit:g} m"?'
                )


def _high_loads(scene: Scene, size: float) -> Iterator[str]:
    """Loads that would double the length of a solid block of the shape's size."""
    moduli = [E for one in scene.material.values() for E in _moduli(one)]
    stiffness = max(moduli, default=0.0)
    if 0.0 < stiffness < (usual := _usual_stress(scene, size)):
        yield (
            f"loads: they give {in_unit('Pa', usual, 3)} over the whole shape, more than the stiffness of its "
            f"material, {in_unit('Pa', stiffness, 3)}: are their units right?"
        )


def _moduli(material: Material) -> Sequence[float]:
    """Young's moduli of a material [Pa]; none of one that has no stiffness."""
    grained = getattr(material, "orthotropic", None)
    return grained.E if grained is not None else [getattr(material, "E", 0.0) or 0.0]


def _strong_gravity(scene: Scene) -> Iterator[str]:
    """Gravity far above that of the earth, as of a number in mm/s^2."""
    g = scene.effects.get("gravity", {}).get("g")
    pull = math.hypot(*g) if isinstance(g, list | tuple) else 0.0
    if pull > STRONG * EARTH:
        yield (
            f"effects.gravity.g: {pull:g} m/s^2 is {pull / EARTH:.3g} times the gravity of the earth, {EARTH} m/s^2: "
            "is its unit right?"
        )


def _limits_in_time(scene: Scene) -> Iterator[str]:
    """Limits that are compared with the end of each frame alone."""
    effects = application_of(scene).effects
    steps = [found.get("steps", 1) for name, found in scene.effects.items() if effects[name].goes_on(found)]
    if not steps or max(steps) < 2:
        return
    for name, quantity in scene.quantities.items():
        may = "peak" in quantity.kinds[quantity.kind].reduced_by
        if may and quantity.max is not None and "reduce" not in table_in(table_in(scene.raw, "quantities"), name):
            yield (
                f"quantities.{name}: its limit is compared with the end of each frame alone, not the {max(steps)} time "
                'steps in it: set reduce = "peak", the largest size over all of them'
            )


def _sums(scene: Scene, outline: Outline) -> Iterator[str]:
    """Sums over nodes of what is no total: they are of the mesh, not of the body."""
    for name, quantity in scene.quantities.items():
        if quantity.reduce != "sum" or quantity.kinds[quantity.kind].reduce == "sum":
            continue
        place = outline.entity(quantity.at) if quantity.at else None
        if place is None or place.edges or place.loops or len(place.vertices) > 1:
            yield (
                f'quantities.{name}: a {quantity.kind} reduced by "sum" is added up over nodes, and grows as the mesh '
                'gets finer: "mean", "max" and "min" do not'
            )


def _mesh(scene: Scene, outline: Outline) -> Iterator[str]:
    """What becomes of a mesh from a file."""
    if not scene.mesh.file:
        return
    from restshape.mesh.importer import of_second_order

    if scene.mesh.order == 1 and of_second_order(scene.folder / scene.mesh.file):
        yield "mesh.file: its elements are of second order, and only their corners are used: set mesh.order = 2"
    bent = [edge.name for edge in outline.edges if edge.kind == "polyline"]
    if scene.mesh.order == 2 and bent:
        yield (
            f"mesh.file: sides on {', '.join(bent[:4])}{', ...' if len(bent) > 4 else ''} stay straight, for the nodes "
            "there lie on no circle and the file has none between them: corners between sides raise stresses; export "
            "the mesh with elements of second order"
        )
    size = scene.mesh.size
    new = f"one of mesh.size = {size:g} m" if size else "one with the usual number of triangles"
    if size:
        yield "mesh.size: the first frame has the mesh of mesh.file as it is; the size is that of meshes made later"
    yield f"mesh.file: where an edit needs a new mesh, {new} takes its place: refinements of the file are lost"


def _drawing(scene: Scene, outline: Outline) -> Iterator[str]:
    """A drawing that does not say its unit."""
    drawing = imported_shape(scene.shape, scene.folder)
    if drawing is not None and drawing.doubt:
        width, height = outline.bounds()[1] - outline.bounds()[0]
        yield f"shape.file: {drawing.doubt}: {width:.4g} m x {height:.4g} m; save it with its unit"


def _curves(scene: Scene, outline: Outline) -> Iterator[str]:
    """Curves that are meshed more coarsely than usual, for there are so many of them."""
    wanted = FULL_TURN / (scene.mesh.edges_per_circle or PER_CIRCLE[scene.mesh.order or 1])
    found = [] if scene.mesh.file else curve_edges(outline, scene.mesh)
    coarse = [one for one in found if one.turn > TOLERATED * wanted]
    if coarse:
        worst = max(coarse, key=lambda one: one.turn)
        named = ", ".join(one.name for one in coarse[:4]) + (", ..." if len(coarse) > 4 else "")
        yield (
            f"mesh: curves of {named} get mesh edges that turn by up to {math.degrees(worst.turn):.3g} degrees, where "
            f"{math.degrees(wanted):.3g} is usual, for finer ones would more than double the triangles: set "
            "mesh.edges_per_circle to have them all the same, or a smaller mesh.size"
        )
