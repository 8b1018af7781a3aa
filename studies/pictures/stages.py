"""Where a frame goes: stages of each level by scene and policy, before and after."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, INK, LEVEL_LABELS, STAGES, new_figure

BESIDE = "beside"
"""What is done after the answer is known: the residual."""
COLOURS = {**STAGES, BESIDE: "#ffffff"}
LABELS = {"other": "Python, rest", BESIDE: "beside the frame"}
PAIR, APART = 0.95, 1.5
"""Distances of the two bars of a policy, and from there to the next policy."""
LEVELS = {"1": LEVEL_LABELS[1], "2": LEVEL_LABELS[2], "3": LEVEL_LABELS[3], "still": "solved at rest"}
INCHES = 0.19
"""Of a bar."""
COLUMNS = 6
"""Of the legend."""
Scenes = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Scene -> policy -> record, as `bench reuse --json` writes it."""


def stage_parts(entry: Mapping[str, Any], level: str) -> dict[str, float]:
    """Milliseconds of each stage of a level, which sum up to its median frame, and of what is beside it.

    Args:
        entry: record of a policy.
        level: "1", "2", "3", or "still": solved on a mesh that rests.

    Returns: by name, in the order of the bars; none where there are no frames.
    """
    if not entry["levels"].get(level):
        return {}
    stages = dict(entry["stages_by_level"][level])
    # Where nothing is said of estimates, what is beside the answer counts as recorded.
    beside, python = stages.pop("record") + stages.pop("estimate", 0.0), stages.pop("python")
    # The time of Python holds that of the edit.
    stages["other"] = max(0.0, python - stages["edit"])
    whole = sum(stages.values())
    factor = entry["ms_by_level"][level]["p50"] / whole if whole else 0.0
    return {name: factor * stages[name] for name in STAGES} | {BESIDE: beside}


def draw_stages(before: Scenes, after: Scenes, titles: tuple[str, str], path: Path) -> None:
    """Writes the picture as a PNG: a row of panels a scene, a panel a level, two bars a policy.

    Bars are in parts of the median frame of the earlier run; where there is none, of the frame itself. Policies with
    another initial guess than their own are left out, as are levels that no scene has frames of.

    Args:
        before, after: what was measured; scenes of `after` are shown.
        titles: what each was measured on, such as "commit 0123abcd".
        path: of the picture.
    """
    rows = {name: [policy for policy in scene if ":" not in policy] for name, scene in after.items()}
    levels = [
        level for level in LEVELS if any(one["levels"].get(level) for scene in after.values() for one in scene.values())
    ]
    most = [max(_bars(before, after, name, level) for level in levels) for name in rows]
    heights = [bars + 1.0 for bars in most]
    figure = new_figure(4.2 * max(2, len(levels)), 2.2 + sum(INCHES * height + 0.7 for height in heights))
    grid = figure.subplots(len(rows), len(levels), squeeze=False, height_ratios=heights)
    drawn: dict[str, Any] = {}
    for line, (name, policies), height in zip(grid, rows.items(), heights):
        for axes, level in zip(line, levels):
            pairs = [(policy, before.get(name, {}).get(policy), after[name][policy]) for policy in policies]
            _panel(axes, pairs, level, height, drawn)
            above = {"xycoords": "axes fraction", "textcoords": "offset points", "ha": "right", "va": "bottom"}
            axes.annotate(LEVELS[level], (1.0, 1.0), (0.0, 4.0), color=FAINT, **above)
        size = f"{after[name][policies[0]]['elements']:,} elements"
        new = "" if name in before else " (not measured before: parts of the frame itself)"
        line[0].set_title(f"{name}, {size}{new}", loc="left", fontweight="bold", pad=19)
    for axes in (axes for axes in grid[-1] if len(axes.get_yticks())):
        axes.set_xlabel("time over that of the earlier run [%]")
    order = [name for name in COLOURS if name in drawn]
    figure.legend(
        [drawn[name] for name in order],
        [LABELS.get(name, name) for name in order],
        loc="outside lower center",
        ncols=COLUMNS,
    )
    figure.suptitle(
        f"Where a frame goes, by stage: before ({titles[0]}), after ({titles[1]})\n"
        "numbers: median frame until its answer [ms], + what is done beside it (residual; no recorder, no estimates)",
        x=0.01,
        ha="left",
        color=INK,
    )
    save_picture(figure, path)


def _bars(before: Scenes, after: Scenes, name: str, level: str) -> float:
    """The height of a scene's panel of a level, in bars."""
    own = [policy for policy, one in after[name].items() if ":" not in policy and one["levels"].get(level)]
    old = before.get(name, {})
    return sum(APART + PAIR * (policy in old and bool(old[policy]["levels"].get(level))) for policy in own)


def _panel(
    axes: Axes,
    pairs: list[tuple[str, Mapping[str, Any] | None, Mapping[str, Any]]],
    level: str,
    height: float,
    drawn: dict[str, Any],
) -> None:
    """Two bars for each policy that has frames of the level, in a panel so many bars high."""
    place, ticks, farthest = 0.0, [], 0.0
    for policy, old, new in pairs:
        parts = [(name, stage_parts(entry, level)) for name, entry in (("before", old), ("after", new)) if entry]
        parts = [(name, part) for name, part in parts if part]
        if not parts or parts[-1][0] != "after":
            continue
        unit = sum(parts[0][1].values()) - parts[0][1][BESIDE]
        for name, part in parts:
            label = f"{policy} {name}" if len(parts) == 1 or name == "before" else name
            ticks.append((place, label if len(parts) > 1 else policy))
            farthest = max(farthest, _bar(axes, place, part, unit, drawn))
            place += PAIR
        place += APART - PAIR
    if not ticks:
        axes.text(0.5, 0.5, "no frames of this level", transform=axes.transAxes, ha="center", color=FAINT)
        axes.set(xticks=(), yticks=())
        axes.spines[:].set_visible(False)
        return
    axes.set(yticks=[at for at, _ in ticks], yticklabels=[label for _, label in ticks])
    # Room for the numbers behind the bars.
    axes.set(xlim=(0.0, 1.45 * farthest), ylim=(height - PAIR, -PAIR))
    axes.tick_params(axis="y", length=0, labelsize=8)
    axes.xaxis.set_major_formatter(PercentFormatter(1.0, decimals=0, symbol=""))


def _bar(axes: Axes, place: float, parts: Mapping[str, float], unit: float, drawn: dict[str, Any]) -> float:
    """A bar of stages with its number; returns where it ends."""
    start = 0.0
    for name, ms in parts.items():
        look = {"hatch": "////", "edgecolor": FAINT} if name == BESIDE else {}
        bar = axes.barh(place, ms / unit, left=start, height=0.8, color=COLOURS[name], linewidth=0, **look)
        if ms >= 0.01 * unit:
            drawn.setdefault(name, bar)
        start += ms / unit
    whole = sum(parts.values()) - parts[BESIDE]
    axes.text(start, place, f" {whole:.3g} + {parts[BESIDE]:.2g}", va="center", fontsize=7.5)
    return start
