"""The pages of studies: Markdown that a reader understands without help, and the words that the table has too."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from restshape_studies.accuracy.chosen import chosen_line
from restshape_studies.accuracy.distance import NAMES
from restshape_studies.accuracy.front import front_of, percent, rates, rivals, slope
from restshape_studies.accuracy.record import BOUNDS, PARTS
from restshape_studies.accuracy.reference import COARSER
from restshape_studies.accuracy.setting import present, shown
from restshape_studies.accuracy.study import Study
from restshape_studies.pictures.work_precision import draw_work_precision

from restshape.application import application
from restshape.report.style import si

Row = dict[str, Any]
Chosen = Row | None

HEADS = ("error", "discretisation", "algebraic", "reuse", "ms a frame, p50", "total, s", "size", "unknowns")
HEADS += ("order", "policy", "tolerance", "varied alone", "")

CLOTH = (
    ": of cloth that of Green's strains and of the second derivatives of the positions, which hinges have of surfaces "
    "fitted to the nodes around each triangle"
)
"""What the energy norm is of cloth."""
FRONT, BELOW = "front", "below what the reference can tell"


def row(record: Row) -> list[str]:
    """A record's line of the table."""
    parts = record["parts"] or dict.fromkeys(PARTS)
    varied = f"{record['varied']} = {shown(record['given'])}" if record["varied"] else ""
    marks = [FRONT] if record["pareto"] else []
    marks += [BELOW] if record["below_reference"] else []
    return [
        percent(record["error"]),
        *(_part(parts[part]) for part in PARTS),
        "–" if record["frame_ms"] is None else f"{record['frame_ms']:.3g}",
        f"{record['total_s']:.3g}",
        si(record["size"], "m"),
        str(record["unknowns"]),
        str(record["order"]),
        record["policy"],
        f"{record['tolerance']:.0e}",
        varied,
        ", ".join(marks),
    ]


def _part(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}"


def measure_name(name: str) -> str:
    """A measure for people."""
    return f"quantity `{name[2:]}`" if name.startswith("q_") else NAMES.get(name, name)


def uncertainty_line(study: Study) -> str:
    """What is known of the reference's own error."""
    return f"the reference's own uncertainty: {percent(study.uncertainty)} ({measure_name(study.measure)})"


def slope_line(study: Study) -> str:
    """The slope of the front, in words."""
    found, front = slope(study.records), front_of(study.records)
    if found is None:
        return f"the front has {len(front)} points: too few above the reference's uncertainty for a slope"
    return f"slope of the front: error ~ time^{found:.2f}: ten times the time divides the error by {10**-found:.3g}"


def rates_lines(study: Study) -> list[str]:
    """How errors fall with the mesh size, in words, of the policy that the grid has most of."""
    policies = [record["policy"] for record in study.records if not record["varied"]]
    if not policies:
        return []
    policy = "auto" if "auto" in policies else policies[0]
    lines = []
    for name, orders in rates(study.records, policy).items():
        told = ", ".join(f"h^{p:.2f} with order {order}" for order, p in orders.items())
        lines.append(f"{measure_name(name)}: {told} (policy {policy})")
    return lines


def values_lines(study: Study) -> list[str]:
    """How the values of a key compare that was tried with several mesh sizes, in words, a line a key."""
    lines = []
    for key, found in rivals(study.records).items():
        own = present(study.scene, application(study.scene.app), key)

        def name(value: Any, own: Any = own) -> str:
            return f"`{shown(own if value is None else value)}`"

        finest = sorted(found.finest.items(), key=lambda pair: pair[1][0])
        told = ", ".join(f"{name(value)} {percent(error)}, which falls as h^{p:.2f}" for value, (error, p) in finest)
        line = f"`{key}`: the error with the finest mesh of each is {told}."
        if found.then:
            then = sorted(found.then.items(), key=lambda pair: pair[1])
            line += f" In frames of {found.ms:.3g} ms it is "
            line += f"{', '.join(f'{name(value)} {percent(error)}' for value, error in then)}."
        lines.append(f"{line} The most accurate is {name(finest[0][0])}.")
    return lines


def reuse_line(study: Study) -> str:
    """Whether reuse stays below the tolerance, in words."""
    known = [record for record in study.records if record["reuse_holds"] is not None]
    if not known:
        return "whether reuse stays below the tolerance is not known at any point"
    failed = [record["name"] for record in known if not record["reuse_holds"]]
    if failed:
        return f"reuse exceeds the tolerance at {len(failed)} of {len(known)} points, a FAILURE: {'; '.join(failed)}"
    worst = max(record["parts"]["reuse"] / record["tolerance"] for record in known)
    where = f"all {len(known)} points" if len(known) == len(study.records) else f"the {len(known)} points that tell"
    return f"reuse stays below the tolerance at {where}: it is at most {worst:.1e} of it"


def solver_line(study: Study) -> str:
    """What the answers have beyond discretisation, in tolerances, in words."""
    shares = [(r["parts"]["reuse"] + r["parts"]["algebraic"]) / r["tolerance"] for r in study.records if r["parts"]]
    if not shares:
        return "what the solver adds to the discretisation is not known at any point"
    worst = max(shares)
    beyond = ": the tolerance ends the iteration on its residual, which bounds no error exactly" * (worst > 1.0)
    return f"reuse and algebraic error together are at most {worst:.2g} times the tolerance{beyond}"


def left_out(study: Study) -> list[str]:
    """What failed, was left out, or lacks a part, with the reason; one line each."""
    lines = [f"{omission.name}: {omission.why}" for omission in study.omissions]
    for record in study.records:
        if record["problem"]:
            lines.append(f"{record['name']}: {record['problem']}")
        elif record["parts"] is None and record["error"] is not None:
            lines.append(f"{record['name']}: error not split, for its other replays took other meshes")
    return lines


def _sentence(words: str) -> str:
    """Words as a sentence."""
    return f"{words[:1].upper()}{words[1:]}."


# --- one scene --------------------------------------------------------------------------------------------------------


def write_page(study: Study, folder: Path, command: str, chosen: Chosen = None) -> None:
    """Writes ``NAME.md`` and ``NAME.png`` of a study.

    Args:
        study: to be reported.
        folder: for both.
        command: that made it.
        chosen: what was picked, if anything was.
    """
    name = study.case.name
    draw_work_precision(
        study.records, measure_name(study.measure).replace("`", ""), study.uncertainty, name, folder / f"{name}.png"
    )
    parts = [
        _head(study, command),
        _varied(study),
        _reference(study),
        _result(study),
        _quantities(study),
        _estimates(study),
    ]
    parts += [_chosen(chosen)] if chosen else []
    parts += [_left_out(study)]
    (folder / f"{name}.md").write_text("\n".join(parts), encoding="utf-8")


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], right: int = 0) -> str:
    """A Markdown table whose first columns are aligned to the right."""
    rule = ["---:" if k < right else "---" for k in range(len(heads))]
    lines = [f"| {' | '.join(cells)} |" for cells in (heads, rule, *rows)]
    return "\n".join(lines) + "\n"


def _head(study: Study, command: str) -> str:
    title = study.scene.title or study.case.name
    return (
        f"# What accuracy costs: {study.case.name}\n\n"
        f"{_sentence(title)} The scene `{study.case.scene.name}` was replayed with the edits of "
        f"`{study.case.edits.name}` under {len(study.records)} settings. Each point of the picture is one of them: "
        "how far its answers are from the right ones (across), and how long it computes at a frame (up).\n\n"
        f"```sh\n{command}\n```\n\n"
        f"![error of the {measure_name(study.measure)} against the time of a frame]({study.case.name}.png)\n"
    )


def _varied(study: Study) -> str:
    grid = [record for record in study.records if not record["varied"]]
    sizes = ", ".join(si(size, "m") for size in sorted({record["size"] for record in grid}, reverse=True))
    orders = " and ".join(str(order) for order in sorted({record["order"] for record in grid}))
    policies = ", ".join(f"`{policy}`" for policy in dict.fromkeys(record["policy"] for record in grid))
    alone: dict[str, dict[str, None]] = {}
    for record in study.records:
        if record["varied"]:
            alone.setdefault(record["varied"], {})[shown(record["given"])] = None
    lines = [
        "## What was varied\n",
        f"- mesh size: {sizes} (the scene's own: {si(study.scene.mesh.size, 'm')})",
        f"- order of the elements: {orders}",
        f"- policy, which says what a frame reuses of those before: {policies}",
        *(f"- `{key}` alone, all else as in the scene: {', '.join(values)}" for key, values in alone.items()),
        "",
        f"All points took the first {study.total} frames of the script. A time is the median of the frames that move, "
        "on one core, each point in a process of its own; `total` counts all frames with the first. Replays that keep "
        "nothing from frame to frame are timed on some of their frames where they are slow, and their total follows. "
        f"Errors are taken at the frames {', '.join(map(str, study.frames))}, and the worst of them counts.\n",
    ]
    return "\n".join(lines)


def _reference(study: Study) -> str:
    plan, fine, coarse = study.plan, study.reference, study.coarser
    size = si(plan.factor * study.scene.mesh.size, "m")
    same = [record["size"] for record in study.records if record["order"] == plan.order]
    finest = min(same or [record["size"] for record in study.records])
    ratio = finest / (plan.factor * study.scene.mesh.size)
    kept = "each frame meshed and solved anew"
    if plan.policy == "refactor":
        kept = "the motion replayed from the start" if study.transient else "each frame from where the one before rests"
    turned = "".join(f", `{key}` = {value}" for key, value in plan.turned.items())
    corners = f", {plan.corners:g} times as fine at the corners of the shape" if plan.corners > 1.0 else ""
    steps = ", with time steps twice as long" if plan.coarse != plan.overrides else ""
    lines = [
        "## What errors are counted from\n",
        f"The same shapes with elements of order {plan.order} of {size}{corners} ({ratio:.2g} times as fine as the "
        f"finest point{' of that order' * bool(same)}), "
        f"{fine['unknowns']:,} unknowns, {kept}, tolerance {fine['tolerance']:g}{turned}. "
        f"A second reference, {COARSER:g} times as coarse ({coarse['unknowns']:,} unknowns{steps}), tells how well "
        "this one is known: their distance is the uncertainty below. Errors smaller than it say only that they are "
        f"small, and are marked *{BELOW}*.\n",
        table(
            ("uncertainty", "measure"),
            [(percent(value), measure_name(name)) for name, value in study.truth.uncertainty.items()]
            + [(percent(study.truth.doubt(q)), f"quantity `{q}`") for q in study.scene.quantities],
            1,
        ),
        "The energy norm is the root of the strain energy of the difference of two displacements, over that of the "
        f"reference{CLOTH * (study.measure == 'strain')}. A frequency or load factor is compared with that of the same "
        "rank; a mode's shape with what the modes of nearly the same value span. A quantity's error is relative to its "
        "largest size over these frames.\n",
    ]
    lines += _closed(study)
    return "\n".join(lines)


def _closed(study: Study) -> list[str]:
    """How far the reference is from closed forms."""
    lines = []
    for name, exact in study.truth.exact.items():
        value = study.truth.values.get("0", {}).get(name)
        if value is not None:
            off = abs(value - exact) / (abs(exact) or 1.0)
            lines.append(
                f"`{name}` has a closed form on the first shape, {exact:.8g}: there errors are counted from it, and "
                f"the reference is {percent(off)} off.\n"
            )
    return lines


def _result(study: Study) -> str:
    known = sorted((r for r in study.records if r["error"] is not None), key=lambda r: r["error"])
    front = front_of(study.records)
    heads = [head or "remarks" for head in HEADS]
    return "\n".join(
        [
            "## The front\n",
            "Points to which no other is better in both error and time:\n",
            table(heads, [row(record) for record in front], 8),
            f"{_sentence(slope_line(study))}\n",
            "Errors fall with the mesh size h as:\n",
            *(f"- {line}" for line in rates_lines(study)),
            *(f"\n{line}" for line in values_lines(study)),
            "\n## All points\n",
            f"`error` is that of the {measure_name(study.measure)}. It has three parts, "
            "reference − answer = (reference − direct) + (direct − tight) + (tight − answer), all on the same meshes. "
            f"*Discretisation* is what the elements cannot do better, even {_direct(study)}. *Reuse* is what keeping "
            "matrices, factors and guesses from frame to frame adds when the solver goes on down to rounding. "
            "*Algebraic* is what the solver's tolerance leaves.\n",
            f"{_sentence(reuse_line(study))} {_sentence(solver_line(study))}\n",
            table(heads, [row(record) for record in known], 8),
        ]
    )


def _direct(study: Study) -> str:
    """What answers are compared with that keep nothing, in words."""
    if study.transient:
        return (
            "with a new complete factor in each solve: motion hangs on all that came before, so that it is replayed as "
            "a whole, with matrices that may be kept (`restshape replay --parity` compares those with new ones)"
        )
    guess = "from where it rests, for other folds are as right" if study.measure == "strain" else "no guess"
    return f"where each sampled frame is solved from nothing on its mesh: new matrices, a new factor, {guess}"


def _quantities(study: Study) -> str:
    """The errors of each quantity and measure at the points of the front."""
    front = front_of(study.records)
    if not front:
        return ""
    names = [*front[0]["errors"], *(f"q_{q}" for q in front[0]["quantities"])]
    rows = []
    for record in front:
        cells = [record["name"]]
        for name in names:
            held = record["quantities"][name[2:]] if name.startswith("q_") else record["errors"][name]
            doubt = " *" if held["worst"] is not None and held["worst"] <= held["uncertainty"] else ""
            cells.append(f"{percent(held['worst'])}{doubt}")
        rows.append(cells)
    heads = ["point of the front", *(measure_name(name) for name in names)]
    text = "Worst over the frames; with a star: " + BELOW + "."
    vague = [q for q in study.scene.quantities if study.truth.doubt(q) > 0.01]
    if vague:
        text += (
            f" The reference itself does not know {' and '.join(f'`{q}`' for q in vague)} to 1 %: such a quantity may "
            "have no limit, as the largest stress at a sharp corner has none."
        )
    return "\n".join(["## Quantities of interest and other measures\n", table(heads, rows), text, ""])


def _estimates(study: Study) -> str:
    """How the estimates of the frames compare with the true errors."""
    told = [record for record in study.records if record["effectivity"]]
    lines = ["## The estimate beside every answer\n"]
    if not told:
        return "\n".join([*lines, "The frames of this scene carry no error estimate.\n"])
    lines.append(
        "Each frame carries an estimate of its error, made without any reference. Its effectivity is estimate over "
        f"true error ({measure_name(told[0]['effectivity']['measure'])}): 1 is perfect, {BOUNDS[0]:g} to {BOUNDS[1]:g} "
        "is wanted.\n"
    )
    if "motion" in told[0]["errors"]:
        lines.append(
            "It is of the mesh at that instant: it knows nothing of what time steps and earlier frames have added, nor "
            "of a phase that is off.\n"
        )
    outside = [record for record in told if not record["effectivity"]["within"]]
    clear = [record for record in outside if not record["below_reference"]]
    if outside:
        lines.append(
            f"It leaves these bounds at {len(outside)} of {len(told)} points, {len(clear)} of which have a true "
            "error that the reference can tell:\n"
        )
        rows = [
            (
                record["name"],
                *(f"{record['effectivity'][key]:.2g}" for key in ("least", "median", "largest")),
                BELOW if record["below_reference"] else "",
            )
            for record in outside
        ]
        lines.append(table(("point", "least", "median", "largest", "remarks"), rows))
    else:
        least, largest = (pick(r["effectivity"][key] for r in told) for pick, key in ((min, "least"), (max, "largest")))
        lines.append(f"At all {len(told)} points it stays within them: {least:.2g} to {largest:.2g}.\n")
    return "\n".join(lines)


def _chosen(chosen: Row) -> str:
    lines = [
        "## What was picked\n",
        f"The setting {chosen['name']}, written as `{chosen['file']}` and replayed over {chosen['frames']} frames, "
        f"errors taken at the frames {', '.join(map(str, chosen['sampled']))}: {chosen_line(chosen)}.\n",
    ]
    if chosen["before"]:
        lines += ["Tried before it:\n", *(f"- {line}" for line in chosen["before"]), ""]
    return "\n".join(lines)


def _left_out(study: Study) -> str:
    lines = left_out(study)
    body = [f"- {line}" for line in lines] or [
        "Nothing: every setting ran to its end, in every frame that was looked at."
    ]
    return "\n".join(["## What failed or was left out, and why\n", *body, ""])


# --- all scenes -------------------------------------------------------------------------------------------------------


def write_index(studies: Sequence[Study], folder: Path, command: str, meshless: Sequence[tuple[str, str]] = ()) -> None:
    """Writes ``README.md``, which explains studies and shows all of them.

    Args:
        studies: one a scene.
        folder: where their pages are.
        command: that made them.
        meshless: name and title of scenes without a mesh, which have pages of their own kind.
    """
    rows = []
    for study in studies:
        front = front_of(study.records)
        if not front:
            continue
        fast, fine = front[0], front[-1]
        found = slope(study.records)
        rows.append(
            (
                f"[{study.case.name}]({study.case.name}.md)",
                measure_name(study.measure),
                f"{percent(fast['error'])} in {fast['frame_ms']:.3g} ms",
                f"{percent(fine['error'])} in {fine['frame_ms']:.3g} ms",
                "–" if found is None else f"{found:.2f}",
                percent(study.uncertainty),
            )
        )
    heads = (
        "scene",
        "error of",
        "fastest point",
        "most accurate point",
        "slope of the front",
        "reference's uncertainty",
    )
    parts = [
        "# What accuracy costs\n",
        "How far is an answer from the right one, and what does a better one cost? Each page here takes one scene and "
        "its edits, replays them under many settings (mesh size, order of the elements, solver tolerance, policy of "
        "reuse, and what else the application knows), and compares every answer with one computed far finer.\n",
        f"```sh\n{command}\n```\n",
        "A picture has the error across and the median time of a frame up, both logarithmic. A point to the left is "
        "more accurate, a lower one is faster. The line joins the points to which no other is better in both: the "
        "front. Its slope p says how the error falls with the time spent: error ~ time^p. What lies "
        "in the grey band is closer to the reference than the reference is to the truth.\n",
        table(heads, rows),
    ]
    for study in studies:
        name = study.case.name
        parts += [f"## [{name}]({name}.md)\n", f"{study.scene.title}\n", f"![{name}]({name}.png)\n"]
        parts += [f"{_sentence(reuse_line(study))}\n"]
        count = len(left_out(study))
        parts += [f"Remarks on its page on what failed or was left out: {count}.\n"] if count else []
    for name, title in meshless:
        parts += [f"## [{name}]({name}.md)\n", f"{title}: it has no mesh, and a study of its own kind.\n"]
        parts += [f"![{name}]({name}.png)\n"]
    (folder / "README.md").write_text("\n".join(parts), encoding="utf-8")
