"""The thesis's numbers of furniture beside ours: table 6.1, and the load at which figure 6.22's nails give."""

from typing import Any

from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.guidance.support_planks import support_planks
from restshape_apps.furniture.physics.furniture import WEAK, Furniture
from restshape_apps.furniture.pieces import cantilever
from restshape_verification.furniture.times import (
    COLUMNS,
    Column,
    all_suggestions,
    candidates,
    dragged,
    edited,
    large,
    timed,
)
from restshape_verification.furniture.validation_statics import gives_way, in_equilibrium

TABLE, FIGURE = "6.1", "figure 6.22"


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides, which need not be `timed`."""
    columns = (row for name in COLUMNS for row in column_rows(name, timed))
    return [*columns, *large_rows(timed), *nail_rows()]


def column_rows(name: str, clocked: bool) -> list[dict[str, Any]]:
    """The rows of a column of table 6.1."""
    column = COLUMNS[name]
    piece = column.make()
    found, supports = all_suggestions(piece)
    common = {"table": TABLE, "row": f"{name}, {column.planks} planks ({column.where})"}
    counted = (
        ("planks", column.planks, len(piece.planks), "planks"),
        ("joints", column.joints, len(piece.joints), "joints"),
        ("design freedoms", "", len(found.modes), "freedoms"),
        ("combinations of at most 3", "", sum(found.tried), "candidates"),
        ("continuous suggestions", column.continuous, len(found.found), "suggestions"),
        ("discrete suggestions", column.discrete, supports, "suggestions"),
    )
    rows = [_row(common, *one, timing=False) for one in counted]
    return rows + [_row(common, *one, timing=True) for one in clock_rows(column)] if clocked else rows


def clock_rows(column: Column) -> list[tuple[str, Any, Any, str]]:
    """Quantity, the thesis's time, ours and its unit, of all that takes time in a column."""
    piece = column.make()
    furniture = Furniture(piece)
    furniture.test()
    solver = PlankEquilibrium(furniture)
    parts, whole = timed(lambda: candidates(piece)), timed(lambda: all_suggestions(piece))
    supports, edit = timed(lambda: support_planks(furniture)), timed(lambda: edited(furniture, solver), 21)
    solver.destroy()
    drag = dragged(piece, all_suggestions(piece)[0])
    search = max(whole.wall - parts.wall - supports.wall, 0.0)
    return [
        ("candidates", column.candidates, parts.wall, "ms"),
        ("line search", column.search, search, "ms"),
        ("discrete suggestions", column.supports, supports.wall, "ms"),
        (f"all suggestions (aim: {column.aim:g} ms)", column.total, whole.wall, "ms"),
        ("equilibrium after an edit", "", edit.wall, "ms"),
        ("ranges in a drag", "", 1e3 / drag.wall, "1/s"),
    ]


def large_rows(clocked: bool) -> list[dict[str, Any]]:
    """The rows of a piece with 224 freedoms, whose 1.8 million combinations of three are all tried."""
    piece = large()
    found, _ = all_suggestions(piece)
    common = {"table": TABLE, "row": f"a bookshelf of {len(piece.planks)} planks"}
    counted = (
        ("design freedoms", 224, len(found.modes), "freedoms"),
        ("combinations of at most 3", "", sum(found.tried), "candidates"),
        ("continuous suggestions", "", len(found.found), "suggestions"),
    )
    rows = [_row(common, *one, timing=False) for one in counted]
    if clocked:
        for quantity, work in (("candidates", candidates), ("all suggestions", all_suggestions)):
            rows.append(_row(common, quantity, "", timed(lambda work=work: work(piece), 3).wall, "ms", timing=True))
    return rows


def nail_rows() -> list[dict[str, Any]]:
    """What three nails of 32 mm bear through 12 mm, and the mass at 0.19 m then; the experiment showed about 1 kg."""
    rows = []
    for name in ("nail-thesis", "nail-experiment"):
        most = gives_way(lambda kilograms, name=name: cantilever(kilograms=kilograms, fastener=name), 0.1, 20.0, WEAK)
        furniture = in_equilibrium(cantilever(kilograms=most, fastener=name))
        common = {"table": FIGURE, "row": f"nail cantilever with 3 nails, {name}"}
        bears = round(abs(float(furniture.forces().bending[1])), 6)
        rows += [
            _row(common, "moment at which it breaks", 1.86, bears, "N m", timing=False),
            _row(common, "mass at its tip then, beside its own", 1.0, round(most, 6), "kg", timing=False),
        ]
    return rows


def _row(common: dict[str, Any], quantity: str, thesis: Any, ours: Any, unit: str, timing: bool) -> dict[str, Any]:
    return {**common, "quantity": quantity, "thesis": thesis, "ours": ours, "unit": unit, "timing": timing}
