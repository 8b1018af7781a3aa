"""Pieces of furniture: those of the thesis's figures in kind, with the planks and joints of its table 6.1."""

from pathlib import Path

import numpy as np
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import Load, Piece, Plank, feet_near, joints_near, weight

from restshape.scene.load import load_scene

NEAR = 0.015
"""How far drawn ends may be from what they are joined to [m]."""

SCENES = Path(__file__).parent / "scenes"


def drawn(name: str, *overrides: str) -> Piece:
    """The piece of a scene, its joints closed.

    Args:
        name: of the scene.
        overrides: ``key=value``, applied before it is read.
    """
    return Furniture(piece_of(load_scene(SCENES / f"{name}.toml", overrides))).moved()


def cantilever(
    width: float = 0.06, arm: float = 0.19, kilograms: float = 0.5, fastener: str = "nail-experiment"
) -> Piece:
    """The nail cantilever of section 6.6.1: a board end-on against an upright one that stands on a foot."""
    values = {"deep": width, "arm": arm, "load": kilograms}
    return drawn("cantilever", *_parameters(values), f"fastener.name={fastener}")


def scales(kilograms: float = 1.6, width: float = 0.06, fastener: str = "nail-experiment") -> Piece:
    """A post with a loaded board on either side: two weak joints, which no single edit mends."""
    return drawn("scales", *_parameters({"load": kilograms, "deep": width}), f"fastener.name={fastener}")


def table(
    slant: float = 0.25,
    thickness: float = 0.012,
    kilograms: float = 50.0,
    fastener: str = "nail-thesis",
    push: float = 0.0,
) -> Piece:
    """A table on three upright boards for legs and a slanted one; `slant` is that leg's lean [m].

    `push` is a sideways force on the top [N], a case of its own.
    """
    values = {"slant": slant, "t": thickness, "load": kilograms, "push": push}
    pushed = ["effects.push={}"] if push else []
    return drawn("table", *_parameters(values), f"fastener.name={fastener}", *pushed)


def chair(back: float = 0.1, kilograms: float = 50.0, thickness: float = 0.012) -> Piece:
    """Chair 1: a seat between two boards for sides, with a back that leans by `back` [m] and a stretcher."""
    return drawn("chair-1", *_parameters({"lean": back, "load": kilograms, "t": thickness}))


def stool_chair(lean: float = 0.12, kilograms: float = 45.0, thickness: float = 0.012) -> Piece:
    """Chair 2: a seat on two slanted boards, with a back board, an arm on it, and three weights."""
    return drawn("chair-2", *_parameters({"lean": lean, "load": kilograms, "t": thickness}))


def shelf_1() -> Piece:
    """Shelf 1: 9 planks and 13 joints, as in the first column of table 6.1."""
    return drawn("shelf-1")


def shelf_2() -> Piece:
    """Shelf 2: 10 planks and 13 joints, as in the second column of table 6.1."""
    return drawn("shelf-2")


def bookshelf_20() -> Piece:
    """The 20-plank bookshelf with 33 joints, as in the third column of table 6.1."""
    return drawn("bookshelf")


def piece_28() -> Piece:
    """The 28-plank piece with 49 joints, as in the fourth column of table 6.1."""
    return drawn("piece-28")


def _parameters(values: dict[str, float]) -> list[str]:
    """Overrides of a scene's parameters."""
    return [f"parameters.{name}={float(value)!r}" for name, value in values.items()]


def joined(
    name: str, planks: list[Plank], weights: tuple[Load, ...] = (), pushes: tuple[Load, ...] = (), **more
) -> Piece:
    """A piece of drawn planks: what is near is joined, what is near the floor stands on it, and joints are closed."""
    fastener = more.pop("fastener", "nail-thesis")
    joints = joints_near(planks, NEAR, fastener=fastener)
    drawn = Piece(tuple(planks), joints, feet_near(planks), weights=weights, pushes=pushes, name=name, **more)
    return Furniture(drawn).moved()


def bookshelf(
    rows: tuple[int, ...],
    dividers: int,
    brackets: int,
    lean: float = 0.08,
    kilograms: float = 3.0,
    heavy: float = 30.0,
    both: bool = True,
) -> Piece:
    """Shelves between upright boards, some of them leaning, with dividers between shelves and brackets outside.

    Args:
        rows: shelves in each bay.
        dividers: short boards between two shelves, each with two joints.
        brackets: boards on the outside, each with one joint.
        lean: of every second upright [m].
        kilograms: on each shelf.
        heavy: on each bracket.
        both: brackets on both sides by turns; else all are on the left.
    """
    t, deep, wide, high = 0.012, 0.25, 0.5, 1.5
    foot = [wide * k for k in range(len(rows) + 1)]
    lean_of = [lean if k % 2 else 0.0 for k in range(len(rows) + 1)]
    planks = [
        Plank.between(f"upright-{k + 1}", (x, 0, 0), (x + l, 0, high), (0, deep, 0), t)
        for k, (x, l) in enumerate(zip(foot, lean_of))
    ]
    spots = []
    for bay, count in enumerate(rows):
        # Shelves of neighbouring bays are not at one height.
        heights = 0.12 + 0.03 * bay + np.arange(count) * (high - 0.25) / max(count - 1, 1)
        for row, z in enumerate(heights):
            ends = [foot[bay + s] + lean_of[bay + s] * z / high + (t / 2 if s == 0 else -t / 2) for s in range(2)]
            planks.append(
                Plank.between(f"shelf-{bay + 1}-{row + 1}", (ends[0], 0, z), (ends[1], 0, z), (0, 0.92 * deep, 0), t)
            )
            if row:
                spots.append((0.5 * (ends[0] + ends[1]) + 0.03 * (-1) ** row, heights[row - 1] + t / 2, z - t / 2))
    for k in range(dividers):
        x, low, up = (spots[::2] + spots[1::2])[k]
        planks.append(Plank.between(f"divider-{k + 1}", (x, 0, low), (x, 0, up), (0, 0.2, 0), t))
    first = len(planks)
    for k in range(brackets):
        z, upright, way = 0.5 + 0.3 * k, -1 if both and k % 2 else 0, 1.0 if both and k % 2 else -1.0
        x = foot[upright] + lean_of[upright] * z / high + way * t / 2
        planks.append(Plank.between(f"bracket-{k + 1}", (x, 0, z), (x + 0.25 * way, 0, z), (0, 0.2, 0), t))
    shelves = range(len(foot), len(foot) + sum(rows))
    weights = [weight(f"on-shelf-{k}", k, kilograms) for k in shelves]
    weights += [weight(f"on-bracket-{k}", first + k, heavy, (0.2, 0.0, 0.5)) for k in range(brackets)]
    return joined(f"{len(planks)} planks", planks, tuple(weights))


PIECES = {
    "cantilever": cantilever,
    "scales": scales,
    "table": table,
    "chair-1": chair,
    "chair-2": stool_chair,
    "shelf-1": shelf_1,
    "shelf-2": shelf_2,
    "bookshelf": bookshelf_20,
    "piece-28": piece_28,
}
"""Pieces by name."""
