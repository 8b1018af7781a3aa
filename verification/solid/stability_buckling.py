"""Hard cases of linear buckling: no load factor at all, slender and stocky, twins, near-mechanisms, loads turned."""

from collections.abc import Iterator

import numpy as np
from restshape_studies.stability.case import Case, Row, Statement, Trial, above, below, near, true
from restshape_studies.stability.columns import FOOT, HINGES, PUSHED, euler
from restshape_studies.stability.known_bounds import CONVERGED, DIRECT
from restshape_studies.stability.scenery import across, drag, rows_of
from restshape_verification.solid.hard_scenes import TWINS, column

from restshape.policy import POLICIES

PULL = '\n[loads.head]\non = "right"\nforce = [{0}, 0]\n'


def set_load(*forces: float) -> list[dict]:
    """Edits that give the head one force [N] after the other."""
    return [{"do": "set", "key": "loads.head.force", "value": [force, 0]} for force in forces]


def unrefused(rows: list[Row]) -> Statement:
    """The statement that no frame is refused; load factors may be infinite."""
    why = next((row["refused"] for row in rows if row["refused"]), "none")
    numbers = [row[key] for row in rows for key in row if key.startswith("mu_")]
    return Statement(
        f"none of {len(rows)} frames refused, no load factor that is no number",
        why,
        why == "none" and not np.isnan(numbers).any(),
    )


def pulled(trial: Trial) -> Iterator[Statement]:
    """A column is pulled, dragged, pushed and pulled again: where nothing buckles the load factor is infinite."""
    text = column(FOOT, PULL.format(1e3)).replace("load_factor = 1 }", "load_factor = 1, at_least = 1 }")
    longer = drag("right", (1, 0.025), across((1, 0.025), (1.1, 0.025), 4))
    rows = trial.rows(text, [*longer, *set_load(-1e3, 2e3)])
    endless = [row["q_first"] == np.inf and row["constraint_status"] == "holds" for row in rows]
    wanted = [True] * (len(rows) - 2) + [False, True]
    yield true("infinite, and the status holds, but where it is pushed", endless == wanted)
    yield true("the note says so", all("nothing buckles" in row["note"] for row in rows if row["q_first"] == np.inf))
    yield near("Euler's load where it is pushed", rows[-2]["q_first"], euler(0.05, np.pi / 2, 1.1) / 1e3, 0.01)
    yield unrefused(rows)


def unloaded(trial: Trial) -> Iterator[Statement]:
    """A column without any load gets one in an edit."""
    rows = trial.rows(column(FOOT, PULL.format(0)), set_load(-1e3))
    yield true("infinite at first", rows[0]["q_first"] == np.inf)
    yield near("Euler's load then", rows[1]["q_first"], euler(0.05, np.pi / 2) / 1e3, 0.01)
    yield unrefused(rows)


def displaced(trial: Trial) -> Iterator[Statement]:
    """Both ends are displaced alike: no strain but rounding, no load, no load factor."""
    ends = '\n[supports.ends]\non = ["left", "right"]\nfix = { x = 0.3, y = -0.2 }\n'
    rows = trial.rows(column(ends))
    yield true("infinite", rows[0]["q_first"] == np.inf)
    yield true("the note says that there is no load", "without a load" in rows[0]["note"])
    yield unrefused(rows)


def thousandth(trial: Trial) -> Iterator[Statement]:
    """A column a thousand times as long as thick: Euler's loads, however small against its stiffness."""
    text = column(height=0.001, size=0.003, modes=2).replace("tolerance = 1e-9", "tolerance = 1e-6")
    rows = trial.rows(text)
    for name, z in (("q_first", 0.5 * np.pi), ("q_second", 1.5 * np.pi)):
        yield near(f"{name[2:]} load factor is Euler's", 1e3 * rows[0][name], euler(0.001, z), 1e-3)
    yield unrefused(rows)


def stocky(trial: Trial) -> Iterator[Statement]:
    """A block as wide as long: load factors far beyond sense are found, in order."""
    rows = trial.rows(column(height=1.0, size=0.2))
    found = [rows[0]["mu_1"], rows[0]["mu_2"]]
    yield true("in order and finite", found[0] <= found[1] and bool(np.isfinite(found).all()))
    yield above("lowest load factor", found[0], 1e4)
    yield below("true residual", rows[0]["residual"], 1e-9)
    yield unrefused(rows)


def neck(trial: Trial) -> Iterator[Statement]:
    """A column cut in its middle to a twenty-fifth folds there, like two struts on a spring."""
    cut = """
[shape.holes.upper]
polygon = [[0.499, 0.026], [0.501, 0.026], [0.501, 0.0495], [0.499, 0.0495]]
[shape.holes.lower]
polygon = [[0.499, 0.0005], [0.501, 0.0005], [0.501, 0.024], [0.499, 0.024]]
"""
    whole = column(HINGES, PUSHED.format(1e3), size=0.03)
    run = trial.replay(whole.replace("\n[material", cut + "\n[material", 1))
    made = run.replay
    (weaker,) = rows_of(run)
    (stronger,) = trial.rows(whole)
    yield below("load factor over that of the whole column", weaker["q_first"] / stronger["q_first"], 0.999)
    analysis = made.analysis
    shape = np.abs(analysis.state.modes.vectors[0].reshape(-1, 2)[:, 1])
    nearest = np.abs(analysis.space.X[:, 0] - 0.5).min()
    yield true("the fold is at the node next to the neck", abs(analysis.space.X[np.argmax(shape), 0] - 0.5) <= nearest)
    yield below("true residual", weaker["residual"], CONVERGED)
    yield unrefused([weaker, stronger])


def there_and_back(trial: Trial) -> Iterator[Statement]:
    """Dragged thinner and thick again, a column has the load factors that it had, and its modes their numbers."""
    text = column(HINGES, PUSHED.format(1e3), height=0.1, size=0.05, modes=3)
    path = across((0.5, 0.1), (0.5, 0.04), 30) + across((0.5, 0.04), (0.5, 0.1), 30)
    rows = trial.rows(text, drag("top", (0.5, 0.1), path))
    far = trial.solved(DIRECT) if trial.policy != "rebuild" else 1e-3
    yield near("load factor as at first", rows[-1]["q_first"], rows[0]["q_first"], far)
    yield true("modes keep their numbers", {row["mode_ids"] for row in rows} == {"1 2 3"})
    yield below("modes missed", sum(row["missed_modes"] for row in rows), 0)
    yield unrefused(rows)


def crossing(trial: Trial) -> Iterator[Statement]:
    """Of two masts one is dragged thicker, then thinner than the other: their modes trade places, and say so."""
    path = across((0, 0.5), (-0.004, 0.5), 8) + across((-0.004, 0.5), (0.004, 0.5), 16)
    rows = trial.rows(TWINS, drag("left", (0, 0.5), path))
    thick, thin = rows[9]["mode_ids"].split(), rows[-1]["mode_ids"].split()
    yield true("the two lowest modes have traded places", thick[:2] == thin[1::-1])
    # The right mast is as it was.
    places = [row["mode_ids"].split().index(thick[0]) + 1 for row in rows[5:]]
    found = [row[f"mu_{place}"] for row, place in zip(rows[5:], places)]
    yield near("load factor of the mast that is left alone", found, rows[9]["mu_1"], 1e-3)
    yield unrefused(rows)


def twins(trial: Trial) -> Iterator[Statement]:
    """Two equal masts: both modes of nearly one factor are found from nothing."""
    rows = trial.rows(TWINS)
    yield near("second load factor is the first", rows[0]["mu_2"], rows[0]["mu_1"], 1e-3)
    yield above("third over second", rows[0]["mu_3"] / rows[0]["mu_2"], 2.0)
    yield true("counted", bool(rows[0]["inertia_checked"]))
    yield unrefused(rows)


def violent(trial: Trial) -> Iterator[Statement]:
    """A column is thrown from half to four times its length in single frames: equal to what is solved from nothing."""
    text = column(height=0.05, size=0.04).replace("tolerance = 1e-9", "tolerance = 1e-8")
    lengths = (2.0, 1.0, 4.0, 0.5, 1.0)
    events = drag("right", (1, 0.025), [(length, 0.025) for length in lengths])
    rows, cold = trial.rows(text, events), trial.rows(text, events, policy="rebuild")
    wanted = [euler(0.05, np.pi / 2, length) for length in lengths]
    yield near("Euler's loads", [1e3 * row["q_first"] for row in rows[2:7]], wanted, 0.02)
    yield near("as from nothing", [r["q_first"] for r in rows], [r["q_first"] for r in cold], 2e-3)
    yield unrefused(rows)


def masts(widths: list[float], gap: float = 0.1, height: float = 1.0, base: float = 0.1) -> tuple[str, float]:
    """A scene of masts [m] on one held base, all pressed by the same traction, and the place of its right side."""
    left = np.cumsum([0.0, *(w + gap for w in widths[:-1])])
    points = [(0.0, 0.0), (left[-1] + widths[-1], 0.0)]
    for k in reversed(range(len(widths))):
        points += [(left[k] + widths[k], height), (left[k], height)]
        points += [(left[k], base), (left[k - 1] + widths[k - 1], base)] if k else []
    sides = list(zip(points, [*points[1:], points[0]]))
    on = {y: ", ".join(f'"e{i}"' for i, (p, q) in enumerate(sides) if p[1] == q[1] == y) for y in (0.0, base, height)}
    text = 'format = "restshape-scene"\nversion = 1\napp = "solid"\n[shape]\noutline = ['
    text += ", ".join(f'"e{i}"' for i in range(len(points))) + "]\n[shape.vertices]\n"
    text += "".join(f"p{i} = [{x}, {y}]\n" for i, (x, y) in enumerate(points)) + "[shape.edges]\n"
    text += "".join(f'e{i} = {{ line = ["p{i}", "p{(i + 1) % len(points)}"] }}\n' for i in range(len(points)))
    text += "[material.steel]\nE = 200e9\nnu = 0.3\nthickness = 0.01\n[effects.solid]\n[effects.buckling]\nmodes = 1\n"
    text += f'[supports.base]\non = [{on[0.0]}, {on[base]}]\nfix = ["x", "y"]\n'
    text += f"[loads.tips]\non = [{on[height]}]\ntraction = [0, -2e7]\n[mesh]\nsize = 0.06\n"
    return text + "[solve]\ntolerance = 1e-4\n[quantities]\nfirst = { load_factor = 1 }\n", float(points[1][0])


def weakest_unknown(trial: Trial) -> Iterator[Statement]:
    """The thickest of five masts is dragged thinner than the others, of which it knows nothing: seen when all rests."""
    text, side = masts([0.05, 0.052, 0.054, 0.056, 0.11])
    for frames in (1, 11):
        way = across((side, 0.5), (side - 0.06875, 0.5), frames)
        run = trial.replay(text, [*drag("e1", (side, 0.5), way), {"do": "idle", "frames": 2}])
        made = run.replay
        errors: list[float] = []

        def look(row: Row, made=made, errors=errors) -> None:
            if row["inertia_checked"]:
                cold = made.analysis.compare_cold().solution
                errors.append(cold)

        rows = rows_of(run, look)
        rest = [row for row in rows if row["event"] in ("release", "idle")]
        bound = 1e-4 if trial.policy == "thesis" else 0.1 * CONVERGED
        yield below(f"error of counted frames against solves from nothing ({frames} frames)", max(errors), bound)
        yield true(
            "counted at rest, none missed then",
            all(r["inertia_checked"] for r in rest) and not rest[-1]["missed_modes"],
        )
        yield below("load factor at the end over the first", rows[-1]["mu_1"] / rows[0]["mu_1"], 0.7)
        yield unrefused(rows)


CASES: dict[str, Case] = {
    "pulled": Case(pulled),
    "unloaded": Case(unloaded),
    "displaced": Case(displaced),
    "thousandth": Case(thousandth),
    "stocky": Case(stocky),
    "neck": Case(neck),
    "there_and_back": Case(there_and_back),
    "crossing": Case(crossing),
    "twins": Case(twins, tuple(POLICIES)),
    "violent": Case(violent),
    "weakest_unknown": Case(weakest_unknown),
}
