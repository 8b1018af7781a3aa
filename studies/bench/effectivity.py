"""Estimated errors of quantities beside true ones: their effectivity at some mesh sizes and orders."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from math import inf, isfinite, sqrt
from pathlib import Path
from typing import Any

from restshape_studies.accuracy.reference import Plan
from restshape_studies.accuracy.setting import refusal, scale_of, scaled, unknowns

from restshape.application import Application, application_of
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.elasticity.thickness_layers import layers_of
from restshape.replay.columns import error_column
from restshape.scene.expressions import Expression
from restshape.scene.load import load_scene
from restshape.scene.model import Scene

FINER = 4.0
"""How many times as fine as the finest point the reference is, where so many unknowns are affordable."""
TIGHT = 1e-6
"""Errors below this share of the value, or the solver's tolerance, are the solver's."""
LOW, HIGH = 0.5, 2.0
"""Effectivities between these are good."""
RESOLVED = 3.0
"""True errors below so many times the estimated one of the reference are not known."""

GOOD, BAD, EXACT, SINGULAR, UNRESOLVED = "good", "bad", "exact", "singular", "unresolved"
"""What is found of a point: inside or outside of `LOW` to `HIGH`; exact, where true and estimated error are within the
solver's tolerance; singular; or of an error that the reference is not good enough for."""


@dataclass(frozen=True)
class Point:
    """A quantity on one mesh.

    Args:
        order: of the elements; size: mesh size over that of the scene.
        quantity: its name; value: [SI].
        true: error against the reference; estimate: of the frame; effectivity: the second over the first.
        assessment: one of those above.
    """

    order: int
    size: float
    quantity: str
    value: float
    true: float
    estimate: float
    effectivity: float
    assessment: str


def study(path: Path, given: Sequence[str], sizes: Sequence[float], announce: Callable[[str], None]) -> dict[str, Any]:
    """The points of a scene's first shape, and why orders are missing.

    Args:
        path: scene file; given: ``key=value`` as after --set.
        sizes: factors of the mesh sizes.
        announce: called with what is tried.

    Raises:
        UserError: the scene has no quantity whose error can be estimated, or its mesh cannot be made finer.
    """
    scene = load_scene(path, given)
    app = application_of(scene)
    if scene.mesh.file:
        raise UserError("a mesh from a file cannot be made finer", f"{path}: mesh.file", "give the scene a [shape]")
    names = [name for name, quantity in scene.quantities.items() if quantity.kind != "area"]
    asked = (*given, *(f"quantities.{name}.error=true" for name in names))
    announce(f"{path.stem}: reference")
    known = _values(path, (*asked, *_reference(path, scene, app, min(sizes), given)), names)
    truth = {name: _closed_form(scene, name) or value for name, value in known.items()}
    points, omitted = [], {}
    for order in sorted(app.orders):
        why = refusal(path, (*given, f"mesh.order={order}"))
        if why:
            omitted[str(order)] = why
            continue
        for size in sizes:
            announce(f"{path.stem}: order {order}, size x {size:g}")
            found = _values(path, (*asked, *scaled(scene, size), f"mesh.order={order}"), names)
            points += [_point(order, size, name, found[name], truth[name], scene.solve.tolerance) for name in names]
    return {"points": [_plain(point) for point in points], "omitted": omitted}


def _plain(point: Point) -> dict[str, Any]:
    """A point for JSON, which knows no infinity."""
    return {key: None if isinstance(v, float) and not isfinite(v) else v for key, v in asdict(point).items()}


def counts(points: Sequence[dict[str, Any]]) -> dict[str, int]:
    """How many points there are of each assessment."""
    return {word: sum(one["assessment"] == word for one in points) for word in (GOOD, BAD, EXACT, SINGULAR, UNRESOLVED)}


def _values(path: Path, overrides: Sequence[str], names: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Values and estimated errors by quantity."""
    row = first_frame(path, overrides).row
    return {name: (float(row[f"q_{name}"]), float(row[error_column(name)])) for name in names}


def _reference(path: Path, scene: Scene, app: Application, finest: float, given: Sequence[str]) -> tuple[str, ...]:
    """What makes the reference of a scene: the highest order, as fine as is affordable, finer still at corners."""
    order = max(order for order in app.orders if not refusal(path, (*given, f"mesh.order={order}")))
    scale = scale_of(scene, app)
    factor = max(finest / FINER, sqrt(unknowns(scene, app, 1.0, order) / scale.reference))
    plan = Plan(factor, order, scale.corners, "rebuild", scale.tolerances)
    layers = (f"mesh.layers={2 * layers_of(scene)}",) if "layers" in app.mesh_keys and order > 1 else ()
    return (*plan.sizes(scene), *layers, f"mesh.order={order}", f"solve.tolerance={scale.tolerances[0]}")


def _closed_form(scene: Scene, name: str) -> tuple[float, float] | None:
    """The value by a closed form, which has no error; None where the scene gives none."""
    value = scene.quantities[name].reference
    if isinstance(value, Expression):
        value = value.evaluate(0.0, 0.0, scene.parameters)
    return None if value is None else (float(value), 0.0)


def _point(
    order: int, size: float, name: str, found: tuple[float, float], truth: tuple[float, float], tolerance: float
) -> Point:
    value, estimate = found
    true, doubt = abs(truth[0] - value), truth[1]
    least = min(tolerance, TIGHT) * abs(value)
    effectivity = estimate / true if true > 0.0 else inf
    if estimate == inf:
        assessment = SINGULAR
    elif true <= least and estimate <= least:
        assessment = EXACT
    elif not isfinite(effectivity) or (isfinite(doubt) and true < RESOLVED * doubt):
        assessment = UNRESOLVED
    else:
        assessment = GOOD if LOW <= effectivity <= HIGH else BAD
    return Point(order, size, name, value, true, estimate, effectivity, assessment)
