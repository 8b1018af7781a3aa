"""Triangles of first and second order on the same edits, with as many unknowns, in one run."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, sqrt
from statistics import mean, median

from restshape_studies.bench.job import Job, Row, run
from restshape_studies.bench.turns import Announce, Play, in_turns, median_ratio

from restshape.application import application_of
from restshape.errors import UserError
from restshape.mesh.generate import generate
from restshape.scene.load import load_scene
from restshape.scene.model import Scene
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

TRIES = 6
"""Meshes that are made to find the size of the second order: the number of unknowns jumps from one to the next."""
NEAR = 0.005
"""Difference of the unknowns, relative, at which the search ends."""


def sizes(scene: Scene, factor: float) -> tuple[str, ...]:
    """``key=value`` as after --set: all mesh sizes of a scene, `factor` times as large."""
    near = tuple(f"mesh.near.{name}={factor * size!r}" for name, size in scene.mesh.near.items())
    return (f"mesh.size={factor * scene.mesh.size!r}", *near)


def outline_of(scene: Scene, path: str) -> Outline:
    """The first shape of a scene whose mesh may be as fine as wanted; `path` is that of the scene.

    Raises:
        UserError: the scene's mesh is not one that restshape makes of plane triangles.
    """
    if scene.mesh.file or "layers" in application_of(scene).mesh_keys:
        what = "only meshes in the plane that are made here can be as fine as wanted"
        raise UserError(what, path, "choose another scene")
    return outline_from_spec(scene.shape, scene.folder)


def equal_size(job: Job, announce: Announce = lambda words: None) -> float:
    """How many times as large second-order triangles are for as many unknowns on the first shape.

    Args:
        job: of the scene with the sizes of the first order.
        announce: called with what is tried.

    Raises:
        UserError: the scene's mesh is not one that restshape makes of plane triangles.
    """
    scene = load_scene(job.scene, job.overrides)
    outline = outline_of(scene, job.scene)
    wanted = len(generate(outline, scene.mesh).X)
    factor, best = 2.0, (inf, 2.0)
    for _ in range(TRIES):
        mesh = generate(outline, load_scene(job.scene, (*job.overrides, *sizes(scene, factor))).mesh)
        found = len(mesh.X) + len(mesh.edge_nodes)
        announce(f"order 2, {factor:.3f} times the size: {2 * found} unknowns, wanted {2 * wanted}")
        best = min(best, (abs(found / wanted - 1.0), factor))
        if best[0] < NEAR:
            break
        factor *= sqrt(found / wanted)
    return best[1]


def study(name: str, job: Job, repeat: int, announce: Announce, play: Play = run) -> Row:
    """The record of a scene, as `bench order --json` writes it: factor of the sizes, a record an order, ratios.

    The orders take turns, so that a slow spell of the machine meets both; a ratio is the median over the turns of order
    2's time over order 1's.

    Raises:
        UserError: the scene or the script cannot be replayed, or not with both orders.
    """
    factor = equal_size(job, announce)
    scene, given = load_scene(job.scene, job.overrides), job.overrides
    jobs = {
        "order 1": replace(job, overrides=(*given, "mesh.order=1")),
        "order 2": replace(job, overrides=(*given, *sizes(scene, factor), "mesh.order=2")),
    }
    turns = in_turns(name, jobs, repeat, announce, play)
    one, two = ([run.rows for run in turns[key]] for key in jobs)
    return {
        "factor": factor,
        "orders": {"1": record(one), "2": record(two)},
        "ratios": {
            "p50": median_ratio([middle(rows) for rows in two], [middle(rows) for rows in one]),
            "all": median_ratio([whole(rows) for rows in two], [whole(rows) for rows in one]),
        },
    }


def moved(rows: Sequence[Row]) -> list[Row]:
    """The frames that moved nodes, without the first."""
    return [row for row in rows[1:] if row["level"]]


def middle(rows: Sequence[Row]) -> float:
    """The median time [ms] of the frames that moved."""
    return median(row["ms"] for row in moved(rows))


def whole(rows: Sequence[Row]) -> float:
    """The time [ms] of all frames that moved."""
    return sum(row["ms"] for row in moved(rows))


def record(runs: Sequence[Sequence[Row]]) -> Row:
    """What was counted in the first of an order's runs, the first frame left out, and the median of their times.

    Raises:
        UserError: nothing moved.
    """
    first = runs[0]
    if not moved(first):
        raise UserError("no frame of the script moves a node", "EDITS", "name a script that drags")
    levels = {str(level): [row for row in first[1:] if row["level"] == level] for level in (1, 2, 3)}
    return {
        "unknowns": first[0]["unknowns"],
        "elements": first[0]["elements"],
        "frames": len(first),
        "levels": {level: len(rows) for level, rows in levels.items()},
        "iterations": {
            level: mean(row["iterations"] for row in rows) if rows else None for level, rows in levels.items()
        },
        "refreshes": sum(row["pc_rebuilt"] for row in first[1:]),
        "p50_ms": median(middle(rows) for rows in runs),
    }
