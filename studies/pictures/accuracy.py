"""Error against time: models of the same bodies, each at several sizes of its elements."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, INK, new_figure

LOOKS = (
    ("#f0a58f", "v"),
    ("#cc6677", "o"),
    ("#882255", "s"),
    ("#88ccee", "^"),
    ("#0072b2", "D"),
    ("#117733", "P"),
)
GOAL = 0.01


def draw_accuracy(records: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Writes the picture as a PNG: the largest error of five frequencies over the time of a frame, a panel a body.

    Args:
        records: a body each: length [mm], points (family, size [mm], ms, error), and the error of Kirchhoff's limit.
        path: of the picture.
    """
    figure = new_figure(10.5, 5.6)
    panels = figure.subplots(1, len(records), sharey=True, squeeze=False)[0]
    families = list(dict.fromkeys(point["family"] for point in records[0]["points"]))
    for axes, record in zip(panels, records):
        for family, (colour, mark) in zip(families, LOOKS):
            points = [point for point in record["points"] if point["family"] == family]
            ms, error = ([point[key] for point in points] for key in ("ms", "error"))
            sizes = f"{points[0]['size']:g} to {points[-1]['size']:g} mm"
            look = {"color": colour, "marker": mark, "ms": 6, "lw": 1.2}
            axes.loglog(ms, [100 * e for e in error], label=f"{family}, {sizes}", **look)
        thin = 100 * record["kirchhoff"]["error"]
        axes.axhline(thin, color=INK, lw=1.0, ls="--", label="Kirchhoff's plate, however fine")
        axes.axhline(100 * GOAL, color=FAINT, lw=1.0, ls=":", label="1 %")
        axes.grid(True, color="#e6e6e6", linewidth=0.6)
        axes.set_xlabel("time of a frame, median [ms]")
        axes.set_title(f"free bar of {record['length']} × 30 × 4 mm")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(lambda value, _: f"{value:g}")
            axis.set_minor_formatter(lambda value, _: "")
    panels[0].set_ylabel("largest error of five frequencies [%]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.suptitle("Five modes out of the plane against 3D elasticity, one core", x=0.01, ha="left", color=INK)
    save_picture(figure, path)
