"""The pages of studies in Markdown: command, picture, tables and a legend."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from restshape_studies.accuracy.chosen import chosen_line
from restshape_studies.accuracy.facts import BELOW, HEADS, facts, left_out, measure_name, reuse_fact, rows
from restshape_studies.accuracy.front import front_of, percent, slope
from restshape_studies.accuracy.record import BOUNDS
from restshape_studies.accuracy.reference import COARSER
from restshape_studies.accuracy.setting import shown
from restshape_studies.accuracy.study import Study
from restshape_studies.pictures.work_precision import draw_work_precision

from restshape.outputs.atomic_files import write_whole
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import PageFile
from restshape.outputs.si_numbers import si

Row = dict[str, Any]
Lines = Sequence[Sequence[str]]

LEGEND = f"""## Legend

- Picture: error across, median time of a frame up, both logarithmic; the line joins the front: the points to which no
  other is better in both. Its slope is p in error ~ time^p. Grey: closer to the reference than that is to the truth.
- error: worst over the sampled frames, against the reference; with a star or "{BELOW}": less than its uncertainty,
  which is the distance of a reference {COARSER:g} times as coarse. The energy norm is relative to the reference's.
- discretisation, algebraic, reuse: parts of the error, on the same meshes: of the elements; of the solver's tolerance;
  of what is kept from frame to frame.
- ms a frame: median of the frames that move, on one core, each point in a process of its own; total: all frames.
- effectivity: the frame's own error estimate over the true error; {BOUNDS[0]:g} to {BOUNDS[1]:g} is wanted.
"""


def table(heads: Sequence[str], lines: Lines, right: int = 0) -> str:
    """A Markdown table whose first columns are aligned to the right."""
    rule = ["---:" if k < right else "---" for k in range(len(heads))]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (heads, rule, *lines)) + "\n"


def write_page(study: Study, folder: Path, command: str, chosen: Row | None = None) -> None:
    """Writes ``NAME.md`` and ``NAME.png`` of a study.

    Args:
        study: to be shown.
        folder: for both.
        command: that made it.
        chosen: what was picked, if anything was.
    """
    name, measure = study.case.name, measure_name(study.measure)
    draw_work_precision(study.records, measure, study.uncertainty, name, folder / f"{name}.png")
    parts = [
        f"# Accuracy and cost: {name}\n",
        f"{study.scene.title or name}\n",
        f"```sh\n{command}\n```\n",
        f"![error of the {measure} against the time of a frame]({name}.png)\n",
        table(("study", ""), [*setup(study), *facts(study)]),
        "## All points\n",
        table(HEADS, rows(study), 8),
        "## Quantities and measures at the front\n",
        _quantities(study),
        "## Effectivity of the error estimate\n",
        _effectivity(study),
    ]
    if chosen:
        errors = ", ".join(map(str, chosen["sampled"]))
        pick = [(chosen["name"], chosen["file"], str(chosen["frames"]), errors, chosen_line(chosen))]
        parts += ["## Picked\n", table(("setting", "scene", "frames", "errors at", "result"), pick)]
        parts += [f"- before it: {line}" for line in chosen["before"]] + [""] * bool(chosen["before"])
    parts += ["## Failed or left out\n", *(f"- {line}" for line in left_out(study) or ["nothing"]), "", LEGEND]
    _write(folder / f"{name}.md", "\n".join(parts))


def setup(study: Study) -> list[tuple[str, str]]:
    """What was varied, and what errors are counted from."""
    grid = [record for record in study.records if not record["varied"]]
    alone: dict[str, dict[str, None]] = {}
    for record in study.records:
        if record["varied"]:
            alone.setdefault(record["varied"], {})[shown(record["given"])] = None
    plan, fine, coarse = study.plan, study.reference, study.coarser
    own, edits = study.scene.mesh.size, study.case.edits
    return [
        ("scene, edits", f"`{study.case.scene.name}`, {f'`{edits.name}`' if edits else 'none: the first shape'}"),
        ("frames; errors at", f"{study.total}; {', '.join(map(str, study.frames))}"),
        ("mesh size", f"{', '.join(si(h, 'm') for h in sorted({r['size'] for r in grid}))} (own: {si(own, 'm')})"),
        ("order", ", ".join(str(order) for order in sorted({record["order"] for record in grid}))),
        ("policy", ", ".join(dict.fromkeys(record["policy"] for record in grid))),
        *((f"{key}, alone", ", ".join(values)) for key, values in alone.items()),
        (
            "reference",
            f"order {plan.order}, {si(plan.factor * own, 'm')}, {fine['unknowns']:,} unknowns, policy {plan.policy}, "
            f"tolerance {fine['tolerance']:g}" + "".join(f", {key} = {value}" for key, value in plan.turned.items()),
        ),
        ("coarser reference", f"{coarse['unknowns']:,} unknowns"),
        *_closed(study),
    ]


def _closed(study: Study) -> list[tuple[str, str]]:
    """How far the reference is from closed forms, from which errors are counted where there are some."""
    lines = []
    for name, exact in study.truth.exact.items():
        value = study.truth.values.get("0", {}).get(name)
        if value is not None:
            off = percent(abs(value - exact) / (abs(exact) or 1.0))
            lines.append((f"{name}, closed form", f"{exact:.8g}; the reference is {off} off"))
    return lines


def _quantities(study: Study) -> str:
    """The errors of each quantity and measure at the points of the front, and the reference's uncertainty of each."""
    front = front_of(study.records)
    if not front:
        return "–\n"
    names = [*front[0]["errors"], *(f"q_{q}" for q in front[0]["quantities"])]
    lines = []
    for record in front:
        compared = [record["quantities"][n[2:]] if n.startswith("q_") else record["errors"][n] for n in names]
        stars = [" *" * (h["worst"] is not None and h["worst"] <= h["uncertainty"]) for h in compared]
        lines.append([record["name"], *(f"{percent(h['worst'])}{star}" for h, star in zip(compared, stars))])
    truth = study.truth
    doubts = [truth.doubt(n[2:]) if n.startswith("q_") else truth.uncertainty.get(n) for n in names]
    lines.append(["reference's uncertainty", *("–" if doubt is None else percent(doubt) for doubt in doubts)])
    return table(["point", *map(measure_name, names)], lines)


def _effectivity(study: Study) -> str:
    """The effectivity of the estimates of the frames."""
    rated = [record for record in study.records if record["effectivity"]]
    if not rated:
        return "The frames carry no error estimate.\n"
    inside = sum(record["effectivity"]["within"] for record in rated)
    lines = [
        [
            record["name"],
            *(f"{record['effectivity'][key]:.2g}" for key in ("least", "median", "largest")),
            BELOW if record["below_reference"] else "",
        ]
        for record in rated
        if not record["effectivity"]["within"]
    ]
    head = f"Of the {measure_name(rated[0]['effectivity']['measure'])}: within the bounds at {inside} of {len(rated)}."
    outside = table(("point outside", "least", "median", "largest", "remarks"), lines) if lines else ""
    return f"{head}\n\n{outside}"


def write_index(studies: Sequence[Study], folder: Path, command: str, meshless: Sequence[tuple[str, str]] = ()) -> None:
    """Writes ``README.md``, which shows all studies.

    Args:
        studies: one a scene.
        folder: where their pages are.
        command: that made them.
        meshless: name and title of scenes without a mesh, which have pages of their own kind.
    """
    lines = []
    for study in studies:
        front = front_of(study.records)
        found = slope(study.records)
        ends = (
            [f"{percent(r['error'])} in {r['frame_ms']:.3g} ms" for r in (front[0], front[-1])] if front else ["–"] * 2
        )
        lines.append(
            (
                f"[{study.case.name}]({study.case.name}.md)",
                measure_name(study.measure),
                *ends,
                "–" if found is None else f"{found:.2f}",
                percent(study.uncertainty),
                reuse_fact(study),
                str(len(left_out(study))),
            )
        )
    lines += [(f"[{name}]({name}.md)", f"{title}: no mesh, a page of its own", *["–"] * 6) for name, title in meshless]
    heads = ("scene", "error of", "fastest point", "most accurate point", "slope p", "reference's uncertainty")
    heads += ("reuse below the tolerance", "failed or left out")
    names = [*(study.case.name for study in studies), *(name for name, _ in meshless)]
    pictures = "\n\n".join(f"![{name}]({name}.png)" for name in names)
    parts = ["# Accuracy and cost\n", f"```sh\n{command}\n```\n", table(heads, lines), LEGEND, f"{pictures}\n"]
    _write(folder / "README.md", "\n".join(parts))


def _write(path: Path, text: str) -> None:
    """Write a page, over an earlier one alone."""
    refuse_foreign(PageFile(path), str(path))
    write_whole(path, text)
