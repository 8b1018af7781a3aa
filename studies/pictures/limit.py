"""Stages of a frame beside the least time that memory and operations allow."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from restshape.outputs.picture_files import save_picture
from restshape.report.style import INK, STAGES, new_figure

LABELS = {"record": "hand-over", "krylov": "krylov (iterations)"}
ALL = (("answer", "until the answer"), ("whole", "in all"))
BOUND = {"bytes": "memory", "flops": "operations"}


def draw_limits(found: Mapping[str, Any], path: Path) -> None:
    """Writes the picture as a PNG: a panel a size, in each a bar a stage with its limit.

    Args:
        found: scene -> what `restshape_studies.commands.bench_limit` measures.
        path: of the picture.
    """
    cases = [(name, one) for name, scene in found.items() for one in scene["triangles"].values()]
    figure = new_figure(9.0, 1.3 + 2.6 * len(cases))
    for axes, (name, one) in zip(figure.subplots(len(cases), 1, squeeze=False)[:, 0], cases):
        stages = [*one["stages"].items(), ("rest", {"ms": one["rest_ms"], "least_ms": 0.0, "fraction": None})]
        longest = max(entry["ms"] for _, entry in stages)
        for place, (stage, entry) in enumerate(stages):
            axes.barh(place, entry["ms"], height=0.74, color=STAGES.get(stage, STAGES["other"]), linewidth=0)
            axes.barh(place, entry["least_ms"], height=0.3, color=INK, linewidth=0)
            words = f"{entry['ms']:.3g} ms"
            if entry["fraction"]:
                words += f", {100 * entry['fraction']:.0f} % reached, bound by {BOUND[entry['bound']]}"
            axes.text(max(entry["ms"], entry["least_ms"]), place, f" {words}", va="center", fontsize=8)
        axes.set(yticks=range(len(stages)), yticklabels=[LABELS.get(stage, stage) for stage, _ in stages])
        axes.set(xlim=(0.0, 1.75 * longest), ylim=(len(stages) - 0.4, -0.6), xlabel="time a frame [ms]")
        axes.tick_params(axis="y", length=0)
        sizes = one["sizes"]
        kind = sizes["preconditioner"]["kind"]
        reached = [f"{one[key]['ms']:.3g} ms {what} ({100 * one[key]['fraction']:.0f} % reached)" for key, what in ALL]
        words = f"{sizes['cells']:,} triangles, {one['iterations']:.1f} iterations ({kind})"
        axes.set_title(f"{name}, {words}: {', '.join(reached)}", loc="left")
    figure.suptitle(
        "A frame of level 1 with an old preconditioner, by stage, one core: median (wide bar) and limit (black)\n"
        "limit: bytes to move over the triad's rate at that working set, or operations over their highest rate",
        x=0.01,
        ha="left",
        color=INK,
    )
    save_picture(figure, path)
