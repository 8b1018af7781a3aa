"""Parameters of materials by region: one table for all elements of a physics."""

from collections.abc import Callable, Sequence

import numpy as np

from restshape.errors import UserError
from restshape.fem.space import Space
from restshape.scene.model import Material, Scene


def table_by_region(scene: Scene, space: Space, row: Callable[[Material], Sequence[float]]) -> np.ndarray:
    """Rows (regions + 1, p) of parameters: row 0 is the rest of the shape, row i + 1 the i-th region.

    Args:
        scene: its materials.
        space: all of its cells must have a material.
        row: the p parameters of a material.

    Raises:
        UserError: a part of the shape has no material.
    """
    regions = [loop.name for loop in space.outline.loops if loop.kind == "region"]
    materials = list(scene.material.values())
    rest = [(material, row(material)) for material in materials if not material.region]
    given = [(material, row(material)) for material in materials if material.region]
    width = len((rest or given)[0][1])
    table = np.full((len(regions) + 1, width), np.nan)
    for material, values in [*rest, *given]:
        rows = [regions.index(name) + 1 for name in material.region] if material.region else slice(None)
        table[rows] = values
    bare = np.flatnonzero(np.isnan(table[space.cell_region, 0]))
    if len(bare):
        x, y = space.X[space.corners[bare[0]]].mean(axis=0)[:2]
        raise UserError(
            f"{len(bare)} triangles lie outside of the regions that have a material, one at ({x:.4g}, {y:.4g}) m",
            f"{scene.path}: material",
            "let one material have no region, or name the regions that are missing",
        )
    return table


def by_cell(table: np.ndarray, region: np.ndarray) -> np.ndarray:
    """Parameters of an element: one row (p,) where all cells lie in the rest of the shape, else one row a cell.

    Args:
        table: (regions + 1, p) as `table_by_region` gives it.
        region: (ne,) of each cell.
    """
    return np.ascontiguousarray(table[region] if np.any(region) else table[0])
