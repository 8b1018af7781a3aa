"""The page of a study of furniture: Markdown that a reader understands without help."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from restshape_studies.accuracy.front import percent
from restshape_studies.accuracy.page import table
from restshape_studies.accuracy.study import Case
from restshape_verification.furniture.plank_precision import draw_plank_precision
from restshape_verification.furniture.plank_study import ALL, DENSE, EXACT, PlankStudy, study_planks

from restshape.cli.options import print_table
from restshape.errors import one_line
from restshape.guidance.ranges import SAMPLES

Lines = list[list[str]]


def range_rows(study: PlankStudy) -> Lines:
    """Lines of samples: what is wrongly reported, intervals that are unseen, time."""
    return [
        [
            str(row["samples"]) + (" (as it is)" if row["samples"] == SAMPLES and row["hints"] else ""),
            "yes" if row["hints"] else "no",
            percent(row["worst"]),
            percent(row["mean"]),
            f"{row['missed']} of {study.intervals}",
            f"{row['ms']:.3g}",
        ]
        for row in study.ranges
    ]


def end_rows(study: PlankStudy) -> Lines:
    """Lines of tolerances of ends."""
    return [[f"{row['tolerance']:.0e}", f"{row['worst']:.1e}", f"{row['ms']:.3g}"] for row in study.ends]


def search_rows(study: PlankStudy) -> Lines:
    """Lines of searches: what they may test, what they tested and found, time."""
    last = len(study.searches) - 1
    names = {0: "as it is"} | ({last: "all"} if study.searches and study.searches[last]["trials"] == ALL.trials else {})
    return [
        [names.get(k, str(row["trials"])), str(row["tested"]), f"{row['found']} of {row['all']}", f"{row['ms']:.3g}"]
        for k, row in enumerate(study.searches)
    ]


def newton_rows(study: PlankStudy) -> Lines:
    """Lines of tolerances of the residual."""
    return [
        [f"{row['tolerance']:.0e}", str(row["steps"]), f"{row['error']:.1e}", f"{row['ms']:.3g}"]
        for row in study.newton
    ]


def ratio_rows(study: PlankStudy) -> Lines:
    """Lines of ratios of compliances."""
    return [[f"{row['ratio']:g}", f"{row['utilisation']:.3g}", f"{row['worst']:.3g}"] for row in study.ratios]


HEADS: dict[str, Sequence[str]] = {
    "ranges": ("samples", "expected ends", "wrong, worst", "mean", "intervals unseen", "ms a range, p50"),
    "ends": ("tolerance", "error of an end, worst", "ms a range, p50"),
    "searches": ("tested at most", "tested", "suggestions found", "ms a search"),
    "newton": ("tolerance of the residual", "Newton steps", "error of a force, relative", "ms"),
    "ratios": (
        "compliance in rotation, of the usual one",
        "largest utilisation of a joint",
        "largest change of a joint's use",
    ),
}
ROWS = {
    "ranges": range_rows,
    "ends": end_rows,
    "searches": search_rows,
    "newton": newton_rows,
    "ratios": ratio_rows,
}


def write_plank_page(study: PlankStudy, folder: Path, command: str) -> None:
    """Writes ``NAME.md`` and ``NAME.png``.

    Args:
        study: of one scene.
        folder: where they go.
        command: that made them.
    """
    name = study.case.name
    draw_plank_precision(study.ranges, study.ends, study.searches, study.ratios, name, SAMPLES, folder / f"{name}.png")
    tables = {kind: table(HEADS[kind], rows(study)) for kind, rows in ROWS.items()}
    found = (
        "Suggestions are those of single modes and combinations that the full test confirms. What the last search "
        "finds, of all combinations where they are few, is the reference. It is made for the first piece of the script "
        "that falls or breaks.\n\n" + tables["searches"]
        if study.searches
        else "No piece of this script asks for suggestions.\n"
    )
    parts = [
        f"# {name}: what accuracy costs\n",
        f"{study.scene.title or name}. Planks are rigid and have no mesh, so that there is no error of one. What "
        "can be found more or less exactly is guidance: where a range ends, which intervals it has, which suggestions "
        "there are. Forces are exact up to Newton's tolerance, once the stiffness of joints is chosen. Times are the "
        "least of five on one core; of ranges, the median over all of them.\n",
        f"```sh\n{command}\n```\n",
        f"![errors against time, a panel a question]({name}.png)\n",
        "## Samples of a range\n",
        f"Ranges of {study.ways} design parameters of the first piece, {study.planks} planks. References have {DENSE} "
        f"samples and ends to {EXACT:.0e} of the way; they have {study.intervals} intervals in all. *Wrong* is "
        "the part of the way looked at where range and reference differ. *Unseen* are intervals of the reference that "
        "no interval of the range meets. With *expected ends*, samples are added around places where the derivative "
        "of forces expects an end. Ends are bisected to 1e-06 of the way here.\n",
        tables["ranges"],
        "## Ends of a range\n",
        f"The same ranges by {SAMPLES} samples and other tolerances, in parts of the way looked at.\n",
        tables["ends"],
        "## Search of suggestions\n",
        found,
        "## Newton's tolerance\n",
        "Forces of all cases of the first piece by SNES, from rest, against those of the least tolerance.\n",
        tables["newton"],
        "## Stiffness of joints\n",
        "Forces in loops of redundant joints depend on the ratio of the joints' compliances in rotation and "
        "translation. It is a choice of the model, not an error that falls: this is how much of an answer hangs on "
        "it. Pieces without loops have no change here.\n",
        tables["ratios"],
    ]
    (folder / f"{name}.md").write_text("\n".join(parts), encoding="utf-8")


def study_and_write(
    case: Case, announce: Callable[[str], None], folder: Path, command: str
) -> tuple[list[dict[str, Any]], str]:
    """The records of the study of a scene, and its title, after its tables are printed and its page is written."""
    found = study_planks(case, announce)
    for kind, heads in HEADS.items():
        rows = ROWS[kind](found)
        if rows:
            print_table(f"{case.name}: {kind}", heads, rows, right=heads)
    write_plank_page(found, folder, command)
    print(f"wrote {one_line(folder / case.name)}.md and .png\n", flush=True)
    return found.records, found.scene.title
