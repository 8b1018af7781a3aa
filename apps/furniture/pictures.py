"""Pictures of furniture: pieces with their joints, suggestions, ranges, force space, valid regions, thickness."""

# More than 15 modules: each picture of the page has a module of its own.

from collections.abc import Callable, Sequence
from pathlib import Path
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.guidance.support_planks import support_planks
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import PIECES, scales, table
from restshape_apps.furniture.regions import RANGES, joint_rays, linearised_and_true, tipping_rays
from restshape_apps.furniture.report.force_space import Region, draw_forces, draw_region, region_marks
from restshape_apps.furniture.report.furniture import (
    DesignDirectionView,
    add_utilisation_bar,
    bounds,
    draw_piece,
    marks_redundant,
)
from restshape_apps.furniture.shape.planks import Piece
from restshape_apps.furniture.small_pieces import toppling

from restshape.errors import UserError
from restshape.guidance.combination_search import Combination, Limits
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import counted
from restshape.report.style import INK, LEVELS, REFUSED, new_figure

SHOWN = ("table", "chair-1", "chair-2", "shelf-1", "shelf-2", "piece-28")
RANGE_OF_USE = "numbers joined by a dash: utilisation of a redundant joint over the ratios of compliance"
SIDES = 3
"""Suggestions shown beside a piece."""


def model(piece: Piece) -> Furniture:
    """The tested model of a piece."""
    furniture = Furniture(piece)
    furniture.test()
    return furniture


def state(furniture: Furniture) -> str:
    """What is wrong with a piece, in words."""
    return "; ".join(furniture.test().words) or "valid"


def headed(name: str, furniture: Furniture, letters: int) -> str:
    """The heading of a piece, in at most two lines of so many letters."""
    return "\n".join(wrap(f"{name}: {state(furniture)}", letters, max_lines=2, placeholder=" …"))


def caption(one: Combination, furniture: Furniture) -> str:
    """What a suggestion changes, and between which changes it is valid."""
    size, lines = furniture.piece.size, []
    for words, part in zip(one.words, one.parts):
        factor, unit = (np.degrees(part), "°") if "turn" in words else (1e3 * size * part, " mm")
        low, high = sorted(factor * t for t in one.span)
        lines.append(f"{words} {signed(factor * one.t)}{unit}\n   valid from {signed(low)} to {signed(high)}{unit}")
    return "\n".join(lines)


def signed(value: float) -> str:
    """A number with its sign."""
    return f"{value:+.0f}".replace("-", "\N{MINUS SIGN}")


def pieces(
    path: Path, names: Sequence[str] = ("table", "chair-1", "chair-2", "shelf-1", "shelf-2", "piece-28")
) -> None:
    """Pieces as they are: joints by the utilisation of their strength, forces of feet, weights."""
    across = min(3, len(names))
    down = -(-len(names) // across)
    figure = new_figure(3.6 * across + 0.7, 3.5 * down)
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for axes, name in zip(panels, names):
        furniture = model(PIECES[name]())
        draw_piece(axes, furniture, headed(name, furniture, 36), numbers=len(furniture.piece.planks) <= 10)
    for axes in panels[len(names) :]:
        axes.set_visible(False)
    add_utilisation_bar(figure, panels)
    _legend(figure, panels)
    _save(figure, path)


def suggestions(path: Path, name: str = "table") -> None:
    """A piece and what its first suggestions make of it, with arrows; a support plank where there is one."""
    furniture = model(PIECES[name]())
    result = state(furniture)
    found = suggest(furniture).found[:SIDES]
    supports = support_planks(furniture)
    if not (found or supports):
        raise UserError(f"{name} has no suggestions: it is {result}", "--piece", "choose a piece that breaks or falls")
    every = [furniture.moved(one.gamma) for one in found] + [one.piece for one in supports[:1]]
    furniture.test()
    box = bounds(furniture.piece, *every)
    count = 1 + len(every)
    figure = new_figure(9.6, 3.6 * (-(-count // 2)))
    panels = figure.subplots(-(-count // 2), 2, squeeze=False).ravel()
    draw_piece(panels[0], furniture, f"{name}: {result}", box=box)
    for axes, one in zip(panels[1:], found):
        draw_piece(
            axes, furniture, caption(one, furniture), DesignDirectionView(one.direction, one.t), numbers=False, box=box
        )
    if supports:
        made = model(supports[0].piece)
        words = f"a support plank: {state(made)}\nit relieves {counted(len(supports[0].relieved), 'joint')}"
        draw_piece(panels[len(found) + 1], made, words, numbers=False, box=box)
    for axes in panels[count:]:
        axes.set_visible(False)
    add_utilisation_bar(figure, panels)
    _legend(figure, panels)
    _save(figure, path)


def _legend(figure: Figure, panels: Sequence[Axes]) -> None:
    """Say under pictures what numbers joined by a dash are, where there are any."""
    if marks_redundant(panels):
        figure.supxlabel(RANGE_OF_USE, x=0.01, ha="left", fontsize=8)


def ranges(path: Path) -> None:
    """The valid range of what is dragged as an annotation: black where the piece is valid, red where it is not."""
    figure = new_figure(9.6, 3.9)
    panels = figure.subplots(1, len(RANGES))
    for axes, (words, make) in zip(panels, RANGES.items()):
        furniture, direction_view = make()
        draw_piece(axes, furniture, headed(words, furniture, 70), direction_view, numbers=False)
    add_utilisation_bar(figure, panels)
    _save(figure, path)


def force_space(path: Path, name: str = "scales", joints: tuple[int, int] | None = None) -> None:
    """Force space: reactions at the two edges of a foot that tips, and moments of two joints, with rays."""
    figure = new_figure(9.6, 6.4)
    left, right = figure.subplots(1, 2)
    rays, names = tipping_rays(model(toppling()))
    draw_forces(left, rays, (0.0, 0.0), (np.inf, np.inf), names, (), "stability: a cantilever that falls")
    furniture = model(PIECES[name]())
    rays, others, names = joint_rays(furniture, joints)
    draw_forces(right, rays, (-1.0, -1.0), (1.0, 1.0), names, others, f"durability: two joints of {name}")
    right.set_aspect("equal", adjustable="box")
    save_picture(figure, path)


def regions(path: Path) -> None:
    """Where pieces are valid over two design parameters, beside what linearised forces say."""
    figure = new_figure(9.6, 4.9)
    panels = figure.subplots(1, 2)
    stable = linearised_and_true(model(toppling()), ("foot: length x", "beam: length x"), (-0.1, 0.5), (-0.4, 0.2))
    durable = linearised_and_true(model(scales()), ("left: length y", "right: length x"), (-0.1, 0.4), (-0.3, 0.1))
    draw_region(panels[0], stable, "a cantilever that falls")
    draw_region(panels[1], durable, "scales, with two weak joints")
    kinds = [int(kind) for region in (stable, durable) for kind in np.unique(region.kind)]
    figure.legend(handles=region_marks(kinds), loc="outside lower center", ncols=3, fontsize=8)
    save_picture(figure, path)


def thickness(path: Path) -> None:
    """What planks of 12 to 18 mm leave room for: the valid region of a table, and its suggestions."""
    figure = new_figure(9.6, 4.6)
    left, right = figure.subplots(1, 2)
    millimetres, lines = np.arange(12, 19), []
    fasteners = {"nail-thesis": (50.0, "32 mm nails, 50 kg"), "dowel": (50.0, "50 mm dowels, 50 kg")}
    counts = np.zeros(len(millimetres), dtype=int)
    for (fastener, (kilograms, words)), mark in zip(fasteners.items(), "os"):
        shares = []
        # Dowels of 8 mm want edges twice as thick.
        thick = millimetres if fastener == "nail-thesis" else millimetres[millimetres >= 16]
        for k, t in enumerate(thick):
            furniture = model(table(thickness=t * 1e-3, kilograms=kilograms, fastener=fastener))
            region = linearised_and_true(furniture, ("leg-4: length y", "leg-4: turn y"), (-0.1, 0.15), (-0.2, 0.2), 51)
            shares.append(100.0 * float((region.kind == 0).mean()))
            if fastener == "nail-thesis":
                counts[k] = len(suggest(furniture, shown=99, limits=Limits(trials=200)).found)
                if t % 2 == 0:
                    _outline(left, region, int(t))
        lines += right.plot(thick, shares, f"{mark}-", color=LEVELS[1 if mark == "o" else 3], label=words)
    left.plot(0.0, 0.0, "X", ms=9, color=REFUSED, mec="white", mew=0.8, label="the table as it is")
    left.set(xlabel=region.x_name, ylabel=region.y_name)
    left.set_title("table with 50 kg: valid above the lines (steps: whole nails)", fontsize=9, loc="left")
    left.legend(fontsize=8, loc="lower left")
    right.set(xlabel="thickness of planks [mm]", ylabel="valid part of the region on the left [%]", ylim=(0, 100))
    beside = right.twinx()
    beside.spines["right"].set_visible(True)
    lines += beside.plot(millimetres, counts, "^:", color=INK, label="suggestions with 32 mm nails")
    beside.set_ylabel("suggestions, of up to 3 modes")
    beside.set_ylim(0, 2.0 * max(int(counts.max()), 1))
    right.legend(handles=lines, fontsize=8, loc="upper left")
    save_picture(figure, path)


def _outline(axes: Axes, region: Region, millimetres: int) -> None:
    """Draw the limit of what is valid with planks of that thickness."""
    number = (millimetres - 12) // 2
    colour, style = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")[number], ("-", "--", "-.", ":")[number]
    valid = (region.kind == 0).astype(float)
    axes.contour(region.x, region.y, valid, levels=[0.5], colors=[colour], linewidths=1.5, linestyles=[style])
    axes.plot([], [], color=colour, ls=style, lw=1.5, label=f"planks of {millimetres} mm")


def _save(figure: Figure, path: Path) -> None:
    """Write a figure with room around its titles."""
    figure.get_layout_engine().set(h_pad=0.08, w_pad=0.06)
    save_picture(figure, path)


PICTURES: dict[str, Callable[[Path], None]] = {
    "pieces": pieces,
    "suggestions": suggestions,
    "ranges": ranges,
    "forces": force_space,
    "regions": regions,
    "thickness": thickness,
}


def draw_named(name: str, path: Path, piece: str | None, joints: tuple[int, int] | None) -> None:
    """Draw one picture, of a piece and joints where they are named."""
    if name == "pieces" and piece:
        pieces(path, (piece,))
    elif name == "suggestions" and piece:
        suggestions(path, piece)
    elif name == "forces" and (piece or joints):
        force_space(path, piece or "scales", joints)
    else:
        PICTURES[name](path)
