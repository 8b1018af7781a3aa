"""Hard cases of meshes of static solids: slivers, sizes 1 : 1000, nearly inverted, three triangles, curved sides."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Row, Statement, Trial, above, below, equal, near, true, valid
from restshape_studies.stability.known_bounds import DIRECT
from restshape_studies.stability.scenery import CLAMPED, PULLED, QUANTITIES, STEEL, across, block, drag, meshed, rows_of
from restshape_verification.solid.hard_scenes import HEAD, plate

from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.policy import POLICIES
from restshape.replay.loop import Replay
from restshape.replay.parity import Parity

STRETCH = '[quantities]\nstretch = { displacement = "x", at = "right", reduce = "mean" }\n'
UNCONTRACTED = STEEL.replace("nu = 0.3", "nu = 0")
"""Steel that a pull makes no thinner, so that a block stretches evenly: sigma / E."""
STRAIN = 1e8 / 200e9
WAVY = block(2.0, 1.0).replace(
    'top = { line = ["c", "d"] }', 'top = { spline = ["c", "d"], through = [[1.5, 1.08], [1, 0.9], [0.5, 1.05]] }'
)
RISE = 0.75**0.5
THREE = f"""
[shape]
outline = ["bottom", "more", "right", "top", "left"]
vertices = {{ a = [0, 0], m = [1, 0], b = [2, 0], c = [1.5, {RISE}], d = [0.5, {RISE}] }}

[shape.edges]
bottom = {{ line = ["a", "m"] }}
more = {{ line = ["m", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}

[loads.pull]
on = "right"
traction = [{1e8 * RISE}, 0]

[mesh]
size = 1.0

[quantities]
stretch = {{ displacement = "x", at = "b" }}
"""
"""Half a hexagon: three triangles."""


def areas(made: Replay) -> np.ndarray:
    """Twice the areas [m^2] of the triangles of a replay's mesh."""
    mesh = made.moving.mesh
    p, q = (mesh.X[mesh.cells[:, k]] - mesh.X[mesh.cells[:, 0]] for k in (1, 2))
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]


def slivers(trial: Trial) -> Iterator[Statement]:
    """A block is pressed to a hundredth of its height without a new mesh: triangles of 1:100 meet a uniform stress."""
    text = HEAD + block(2.0, 1.0) + UNCONTRACTED + CLAMPED + PULLED + meshed(0.15) + "min_quality = 1e-6\n" + STRETCH
    heights = np.geomspace(1.0, 0.01, 20)[1:]
    run = trial.replay(text, drag("top", (1.0, 1.0), [(1.0, float(h)) for h in heights]), ["solve.tolerance=1e-9"])
    made = run.replay
    check, worst = Parity(made), []
    rows = rows_of(run, lambda row: check() and worst.append(row["min_quality"]))
    yield near("stretch is the exact one", [row["q_stretch"] for row in rows], STRAIN * 2.0, DIRECT)
    if trial.policy in ("auto", "refactor"):
        yield below("quality of the worst triangle", float(np.nanmin(worst)), 0.05)
    yield from (*equal(check), *valid(rows))


def gradation(trial: Trial) -> Iterator[Statement]:
    """Triangles from 0.2 m down to 0.2 mm in one mesh, whose fine corner is dragged."""
    mesh = meshed(0.2) + "near = { a = 2e-4 }\n"
    text = HEAD + block(2.0, 1.0) + UNCONTRACTED + CLAMPED + PULLED + mesh + STRETCH
    run = trial.replay(text, drag("c", (2.0, 1.0), across((2.0, 1.0), (2.0, 1.3), 6)))
    made = run.replay
    check, sizes = Parity(made), []

    def look(row: Row) -> None:
        check()
        twice = areas(made)
        sizes.append(float(np.sqrt(twice.max() / twice.min())))

    rows = rows_of(run, look)
    yield above("largest over smallest length", min(sizes), 500)
    yield near("stretch before the drag is the exact one", rows[0]["q_stretch"], STRAIN * 2.0, DIRECT)
    yield from (*equal(check), *valid(rows, residual=2e-6))


def near_inversion(trial: Trial) -> Iterator[Statement]:
    """500 drags of random places in random directions over a coarse mesh that may come close to inversion."""
    seeds, bad, worst, shown, refused = trial.count(500), [], 1.0, 0, 0
    text = plate(0.3) + "[solve]\ntolerance = 1e-8\n"
    for seed in range(seeds):
        random = np.random.default_rng(seed)
        on, start = [("window", (0.5, 0.5)), ("c", (2.0, 1.0)), ("window.v1", (0.65, 0.5)), ("top", (1.0, 1.0))][
            int(random.integers(4))
        ]
        angle, far = random.uniform(0, 2 * np.pi), random.uniform(0.2, 1.2)
        end = (start[0] + far * np.cos(angle), start[1] + far * np.sin(angle))
        law = ["effects.large_deformation={}"] if seed % 5 == 4 else []
        run = trial.replay(text, drag(on, start, across(start, end, 8)), ["mesh.min_quality=1e-3", *law])
        made = run.replay
        flat: list[float] = []
        rows = rows_of(run, lambda row, flat=flat, made=made: flat.append(float(areas(made).min())))
        good = [row for row in rows if not row["refused"]]
        numbers = [row[key] for row in good for key in ("q_stretch", "q_peak", "q_wall", "q_energy", "residual")]
        if not np.isfinite(numbers).all() or min(flat) <= 0 or max(row["residual"] for row in good) > 1e-7:
            bad.append(seed)
        worst = min(worst, *(row["min_quality"] for row in good if row["min_quality"] > 0))
        shown, refused = shown + len(good), refused + len(rows) - len(good)
    yield Statement(
        f"in none of {seeds} drags a number that is none, an inverted triangle or a residual above 1e-7",
        f"seeds {bad}" if bad else f"{shown} frames shown, {refused} refused",
        not bad,
    )
    if trial.policy in ("auto", "refactor"):
        yield below("quality of the worst triangle met", worst, 0.05)


def three_triangles(trial: Trial) -> Iterator[Statement]:
    """A mesh of three triangles, of either order and law, is dragged: the exact uniform stress."""
    for order in (1, 2):
        for law in ("", "[effects.large_deformation]\n"):
            # P = E l (l^2 - 1) / 2 of the law of St. Venant and Kirchhoff, to second order in the strain.
            strain = STRAIN * (1 - 1.5 * STRAIN) if law else STRAIN
            supported = f'[supports.wall]\non = "left"\nfix = {{ x = "{strain!r}*x", y = 0 }}\n'
            text = HEAD + THREE + UNCONTRACTED + law + supported
            settings = ["solve.tolerance=1e-10", f"mesh.order={order}"]
            rows = trial.rows(text, drag("right", (2.0, 0.0), across((2.0, 0.0), (2.3, 0.0), 4)), overrides=settings)
            name = f"order {order}{', large' if law else ''}"
            yield true(
                f"three triangles ({name})", {row["elements"] for row in rows} == {3}, float(rows[0]["elements"])
            )
            found = [rows[0]["q_stretch"] / 2.0, rows[-1]["q_stretch"] / 2.3]
            yield near(f"stretch is the exact one ({name})", found, strain, 1e-5 if law else DIRECT)
            yield from valid(rows)


def jacobians(made: Replay) -> float:
    """The least determinant of the maps of all second-order triangles, over twice the area of their corners'."""
    mesh = made.analysis.space
    s = np.linspace(0, 1, 7)
    points = np.array([(x, y) for x in s for y in s if x + y <= 1])
    _, slopes = quadratic_basis(points)
    J = np.linalg.det(np.einsum("qia,eib->eqab", slopes, mesh.X[mesh.cells]))
    p, q = (mesh.X[mesh.corners[:, k]] - mesh.X[mesh.corners[:, 0]] for k in (1, 2))
    return float((J / (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])[:, None]).min())


def _curved(trial: Trial, text: str, events: list[dict], refused: int | None) -> tuple[list[Row], list[Statement]]:
    """The rows of a replay of second order, and what must hold of every such one."""
    run = trial.replay(text, events, ["mesh.order=2"])
    made = run.replay
    check, least = Parity(made), []

    def look(row: Row) -> None:
        check()
        least.append(jacobians(made))

    rows = rows_of(run, look)
    return rows, [above("Jacobian of the worst place", min(least), 1e-6), *equal(check), *valid(rows, refused)]


def bulging_arc(trial: Trial) -> Iterator[Statement]:
    """A side of a hole bulges into the body as an arc, second-order triangles on it, and is undone."""
    events = [{"do": "arc", "on": "window.2", "bulge": 1.4, "frames": 30}, {"do": "undo"}]
    rows, statements = _curved(trial, plate(0.3), events, 0)
    yield from statements
    yield near("stretch after the undo", rows[-1]["q_stretch"], rows[0]["q_stretch"], 1e-2)


def pulled_corner(trial: Trial) -> Iterator[Statement]:
    """A corner of a round hole is pulled far along the plate and back, with curved second-order triangles."""
    start = (0.65, 0.5)
    path = [*across(start, (1.6, 0.55), 25), *across((1.6, 0.55), (0.6, 0.5), 25)]
    rows, statements = _curved(trial, plate(0.25), drag("window.v1", start, path), None)
    yield from statements
    yield below("frames refused", sum(bool(row["refused"]) for row in rows), 25)


def wavy_edge(trial: Trial) -> Iterator[Statement]:
    """A wavy edge is pressed into the plate, its corner first, and drawn out, in coarse and in finer meshes."""
    for size in (0.4, 0.15):
        text = HEAD + WAVY + STEEL + CLAMPED + PULLED + meshed(size) + QUANTITIES
        path = [*across((2.0, 1.0), (2.0, 0.2), 20), *across((2.0, 0.2), (2.3, 1.3), 20)]
        rows, statements = _curved(trial, text, drag("c", (2.0, 1.0), path), None)
        yield from statements
        yield below("frames refused", sum(bool(row["refused"]) for row in rows), 20)


def jerk(trial: Trial) -> Iterator[Statement]:
    """A hole is thrown over the whole plate and back in single frames, with curved second-order triangles."""
    events = drag("window", (0.5, 0.5), [(1.5, 0.5), (0.5, 0.5), (1.5, 0.6), (0.45, 0.4)])
    yield from _curved(trial, plate(0.2), events, 0)[1]


CASES: dict[str, Case] = {
    "slivers": Case(slivers),
    "gradation": Case(gradation, ("auto", "thesis")),
    "near_inversion": Case(near_inversion, share=0.06),
    "three_triangles": Case(three_triangles, tuple(POLICIES)),
    "bulging_arc": Case(bulging_arc),
    "pulled_corner": Case(pulled_corner),
    "wavy_edge": Case(wavy_edge),
    "jerk": Case(jerk),
}
