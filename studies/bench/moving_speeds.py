"""Rows of the thesis's table 4.3 of a case whose mesh moves in each frame: triangles, and frames a second."""

from dataclasses import dataclass
from typing import Any

from restshape_studies.bench.reuse import BASES, Plan, compare
from restshape_studies.bench.turns import Case

from restshape.interface.first_frame import first_frame

POLICIES = ("auto", "thesis", "refactor", "rebuild")


@dataclass(frozen=True)
class Known:
    """What the thesis says of a case.

    Args:
        row: of table 4.3.
        triangles: of its mesh.
        reuse, rebuild: its frames a second, with and without reuse.
    """

    row: str
    triangles: int
    reuse: float
    rebuild: float


def moving_rows(case: Case, known: Known, frames: int, timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`: `timing` marks those that a clock decides, `rounding` those of a mesh's last digits.

    Args:
        case: its scene and script.
        known: what the thesis says.
        frames: of the script, the first included.
        timed: rows that a clock decides, too.
    """
    common = {"table": "4.3", "row": known.row}
    elements = first_frame(case.scene).row["elements"]
    counted = {**common, "quantity": "triangles", "thesis": known.triangles, "ours": elements, "unit": "triangles"}
    counted |= {"timing": False, "rounding": True}
    # Policies take turns on a warm machine, so that a slow spell of it favours none.
    found = compare(case, Plan(POLICIES, frames=frames), lambda words: None) if timed else {}
    of_thesis = {"auto": known.reuse, "thesis": known.reuse, "rebuild": known.rebuild}
    middle = {name: entry["moves"]["p50"] for name, entry in found.items()}
    speeds = [
        {
            **common,
            "quantity": f"frames a second in which the mesh moves, a step a frame (p50), policy {name}",
            "thesis": of_thesis.get(name, ""),
            "ours": 1e3 / ms,
            "unit": "1/s",
            "timing": True,
        }
        for name, ms in middle.items()
    ]
    gains = [
        {
            **common,
            "quantity": f"policy auto over {base}, in such frames",
            "thesis": round(known.reuse / known.rebuild, 2) if base == "rebuild" else "",
            "ours": middle[base] / middle["auto"],
            "unit": "ratio",
            "timing": True,
        }
        for base in (BASES if timed else ())
    ]
    return [counted, *speeds, *gains]
