"""The columns of a recording's table: one row a frame."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from restshape.errors import UserError
from restshape.findings import FINDINGS_BYTES
from restshape.replay.recorded_places import PLACES_BYTES, SINGULAR_PLACES, places_wanted

if TYPE_CHECKING:
    import numpy.typing as npt

    from restshape.application import Application
    from restshape.scene.model import Scene

ALIASES = {
    "bending_utilisation": "bending_use",
    "constraint_status": "verdict",
    "converged": "at_rest",
    "deflection": "sag",
    "event": "do",
    "factorisations": "factors",
    "inertia_checked": "counted",
    "max_penetration": "deepest",
    "missed_modes": "missed",
    "mode_ids": "track",
    "pc_age": "age",
    "pc_rebuilt": "refreshed",
    "relaxation_steps": "steps",
    "slip_distance": "dragged",
    "stability_margin": "margin",
    "tangent_positive_definite": "stable",
    "unbalanced_load": "missing",
    "utilisation": "use",
    "violated_constraints": "broken",
}
"""Columns and fields by their names today: what recordings of version 0.1 call them."""

T = TypeVar("T")


def renamed(table: Mapping[str, T]) -> dict[str, T]:
    """A table, or fields, of a recording by the names of today, whatever names it was written with."""
    today = {old: new for new, old in ALIASES.items()}
    return {today.get(name, name) if today.get(name) not in table else name: values for name, values in table.items()}


STAGES = (
    "edit",
    "relocate",
    "map",
    "flip",
    "mesh",
    "pattern",
    "values",
    "factor",
    "krylov",
    "observe",
    "estimate",
    "record",
)
ESTIMATES = ("estimate", "estimate_time", "prediction_error")
"""What is estimated, or measured, of a frame's error."""


QUANTITY = "q_"
"""Begins the columns of values of quantities."""
LIMITS = ("min", "max")
"""Keys by which a scene limits a quantity."""
UNTRUSTED = "untrusted"
"""Why the answer of a frame cannot be trusted, though it is one: a text; empty where it can."""
SIMULATED = "time"
"""The simulated time [s] at the end of a frame, of analyses in time: a column of `Application.own_columns`."""


PREDICTED = ("linear", "gmls")
"""Ways in which frames of a drag are predicted."""
SAMPLED: dict[str, npt.DTypeLike] = {
    "samples": np.int64,
    "samples_projected": np.int64,
    "sample_ages": "S80",
    "sample_epsilon": np.float64,
    "solver_steps": np.int64,
    "idle_time": np.float64,
    "idle_spent": np.float64,
    "idle_work": "S40",
}
"""Columns of replays that are predicted from several samples."""
REFINED: dict[str, npt.DTypeLike] = {"level_shown": np.int64, "fine_age": np.int64}
"""Columns of those that are predicted on a coarse mesh, and shown on a fine one."""


def error_column(quantity: str) -> str:
    """The column of the estimated errors of a quantity."""
    return f"{quantity}_error"


def jump_column(quantity: str) -> str:
    """The column of what changes of the mesh alone do to a quantity."""
    return f"{quantity}_jump"


def distance_column(quantity: str) -> str:
    """The column of how far predicted values of a quantity are from solved ones, as estimated."""
    return f"{quantity}_distance"


def limit_column(quantity: str, key: str) -> str:
    """The column of a limit, `min` or `max`, that follows parameters."""
    return f"{quantity}_{key}"


def quantity_column(quantity: str) -> str:
    """The column of the values of a quantity."""
    return f"{QUANTITY}{quantity}"


def columns_beside(quantity: str) -> list[str]:
    """The columns that a recording may have beside the values of a quantity."""
    own = [error_column(quantity), jump_column(quantity), distance_column(quantity)]
    return [*own, *(limit_column(quantity, key) for key in LIMITS)]


def quantity_names(table: Iterable[str]) -> list[str]:
    """The quantities of a table with these columns, in their order.

    Of a quantity `q` the column `q_error` is no quantity; a scene that had both is refused (`columns_of`).
    """
    found = [name.removeprefix(QUANTITY) for name in table if name.startswith(QUANTITY)]
    beside: set[str] = set()
    # A column beside a quantity has a longer name than it.
    for name in sorted(found, key=len):
        if quantity_column(name) not in beside:
            beside.update(columns_beside(name))
    return [name for name in found if quantity_column(name) not in beside]


def estimated_quantities(scene: Scene, application: Application) -> list[str]:
    """Quantities of which errors are estimated where its analysis can."""
    return [name for name, one in scene.quantities.items() if one.wants_error] if application.editing.has_mesh else []


def jumps_wanted(scene: Scene, application: Application) -> bool:
    """Whether frames report what changes of the mesh alone do to quantities."""
    has_mesh = application.editing.has_mesh
    return scene.solve.jumps is not False and has_mesh and all(one.mesh_jumps for one in application.physics)


def asked_errors(scene: Scene) -> list[str]:
    """The quantities whose errors a scene asks for, each by itself."""
    # As of `columns_of`.
    from restshape.scene.plain_values import table_in

    given = table_in(scene.raw, "quantities")
    return [name for name in given if table_in(given, name).get("error") is True]


def refuse_asked_jumps(scene: Scene, application: Application) -> None:
    """Refuses jumps by the mesh that a scene asks for where there are none.

    Raises:
        UserError: it does.
    """
    if scene.solve.jumps and not jumps_wanted(scene, application):
        what = "what the mesh alone does cannot be estimated in such scenes, which have several answers"
        raise scene.located(UserError(what, "solve.jumps", "leave it out"))


def columns_of(scene: Scene, application: Application, predict: str = "none") -> dict[str, npt.DTypeLike]:
    """The columns of replays of a scene.

    Args:
        scene, application: that are replayed.
        predict: as after `--predict`.

    Raises:
        UserError: a quantity has a name with which two columns would have the same one.
    """
    # The process of the recorder, which asks for names of columns, knows no scenes.
    from restshape.replay.constraints import moving_limits

    known = columns(list(scene.quantities), application.own_columns(scene))
    own = {error_column(name): name for name in estimated_quantities(scene, application)}
    if jumps_wanted(scene, application):
        own |= {jump_column(name): name for name in scene.quantities}
    own |= {distance_column(name): name for name in scene.quantities if predict in PREDICTED}
    own |= {limit_column(name, key): name for name, key in moving_limits(scene)}
    values = set(map(quantity_column, scene.quantities))
    beside = {column: name for name in scene.quantities for column in columns_beside(name) if column in values}
    for column, name in (beside | own).items():
        if column in known:
            what = f"a column of it would be {column}, which is another column"
            raise scene.located(UserError(what, f"quantities.{name}", "give it another name"))
    places = {SINGULAR_PLACES: f"S{PLACES_BYTES}"} if places_wanted(scene, application) else {}
    sampled = SAMPLED if predict == "gmls" else {}
    if predict == "gmls" and scene.predicted_levels > 1:
        sampled = sampled | REFINED
    return known | dict.fromkeys(own, np.float64) | places | sampled


def columns(quantities: list[str], own: dict[str, npt.DTypeLike] | None = None) -> dict[str, npt.DTypeLike]:
    """Name to numpy type, or `str`, of each column.

    Args:
        quantities: of the scene.
        own: columns that only the scene's application has.
    """
    integers = (
        "index",
        "line",
        "level",
        "flips",
        "pc_age",
        "pc_rebuilt",
        "iterations",
        "newton",
        "unknowns",
        "elements",
        "predicted",
        "stale",
    )
    times = ("ms", *(f"ms_{name}" for name in STAGES), "ms_python")
    reals = ("t", "min_quality", "mesh_area", "residual", *ESTIMATES, *times)
    return {
        **dict.fromkeys(integers, np.int64),
        **dict.fromkeys(reals, np.float64),
        **{quantity_column(name): np.float64 for name in quantities},
        "event": str,
        "preconditioner": "S24",
        "note": "S160",
        "constraint_status": "S16",
        "violated_constraints": "S160",
        "findings": f"S{FINDINGS_BYTES}",
        "refused": str,
        **(own or {}),
    }
