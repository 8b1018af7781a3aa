"""Materials by region, as a scene gives them: one reader for all physics."""

from collections.abc import Callable, Sequence

import numpy as np

from restshape.errors import UserError
from restshape.fem.space import Space
from restshape.scene.model import Material, Scene
from restshape.shape.outline import Outline


def names_by_region(scene: Scene, space: Space) -> list[str | None]:
    """Names of the materials of the rest of the shape, then of each region; None where there is neither cell nor name.

    A material of a group of regions is that of its members.

    Args:
        scene: its materials.
        space: all of its cells must have a material.

    Raises:
        UserError: a part of the shape has no material.
    """
    regions = [loop.name for loop in space.outline.loops if loop.kind == "region"]
    rest, given = materials_of_regions(scene, space.outline)
    names = [rest, *(given.get(region, rest) for region in regions)]
    nameless = [row for row, name in enumerate(names) if name is None]
    if nameless and len(bare := np.flatnonzero(np.isin(space.cell_region, nameless))):
        x, y = space.X[space.corners[bare[0]]].mean(axis=0)[:2]
        raise UserError(
            f"{len(bare)} triangles lie outside of the regions that have a material, one at ({x:.4g}, {y:.4g}) m",
            "material",
            "let one material have no region, or name the regions that are missing",
        )
    return names


def materials_of_regions(scene: Scene, outline: Outline) -> tuple[str | None, dict[str, str]]:
    """The name of the material of the rest of a shape, if there is one, and those of regions by theirs.

    A material of a group of regions is that of its members.
    """
    rest = next((name for name, material in scene.material.items() if not material.region), None)
    given = {region: name for name, material in scene.material.items() for region in material.region or ()}
    for group, members in outline.groups.items():
        given |= {member: given[group] for member in members if group in given}
    return rest, given


def table_by_region(scene: Scene, space: Space, row: Callable[[Material], Sequence[float]]) -> np.ndarray:
    """Rows (regions + 1, p) of parameters: row 0 is the rest of the shape, row i + 1 the i-th region.

    Args:
        scene: its materials.
        space: all of its cells must have a material; rows without cells may have none, and are not numbers.
        row: the p parameters of a material.

    Raises:
        UserError: a part of the shape has no material.
    """
    names = names_by_region(scene, space)
    rows = {name: row(scene.material[name]) for name in names if name is not None}
    absent = np.full(len(next(iter(rows.values()))), np.nan)
    return np.array([absent if name is None else rows[name] for name in names], dtype=float)


def by_cell(table: np.ndarray, region: np.ndarray) -> np.ndarray:
    """Parameters of an element: one row (p,) where all cells lie in the rest of the shape, else one row a cell.

    Args:
        table: (regions + 1, p) as `table_by_region` gives it.
        region: (ne,) of each cell.
    """
    return np.ascontiguousarray(table[region] if np.any(region) else table[0])


def require_value(scene: Scene, key: str, what: str, do: str) -> None:
    """Refuse a scene in which the value of a key of a material is 0 or missing.

    Args:
        scene: its materials.
        key: such as "rho".
        what, do: of the refusal.

    Raises:
        UserError: a material has no such value.
    """
    for name, material in scene.material.items():
        if not getattr(material, key):
            raise UserError(what, f"material.{name}", do)
