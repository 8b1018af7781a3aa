"""Outlines from drawings, in whatever format they come."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from restshape.bounds import BULGE, LENGTH, OUTLINE_PIECES
from restshape.errors import UserError
from restshape.scene.model import ShapeSpec
from restshape.scene.permits import scripts_trusted
from restshape.scene.plain_values import Table
from restshape.shape.drawings.gaps import Gap
from restshape.shape.drawings.loose_curve import Curve, LooseCurves
from restshape.shape.drawings.unordered_curves import shape_data

Reader = Callable[[Path, Mapping[str, str]], LooseCurves]


@dataclass(frozen=True)
class ImportedShape:
    """What a file draws.

    Args:
        tables: the plain tables of a ``[shape]``.
        gaps: between ends that `shape.tolerance` let close, the largest first.
        notes: what was chosen of the file.
        doubt: what the file does not say of its unit, and what is taken; "": it says its unit.
    """

    tables: Table
    gaps: tuple[Gap, ...]
    notes: tuple[str, ...]
    doubt: str


def imported_shape(spec: ShapeSpec, folder: Path) -> ImportedShape | None:
    """What the file that a ``[shape]`` names draws; None where it names none.

    Args:
        spec: of a scene.
        folder: that the file's name is relative to.

    Raises:
        UserError: there is no such file, it cannot be read, or its curves make no loops.
    """
    if spec.file is None:
        return None
    path = Path(spec.file) if Path(spec.file).is_absolute() else folder / spec.file
    known = _readers(scripts_trusted())
    if path.suffix.lower() not in known:
        raise UserError(f"no outline can be read from {path.name}", "shape.file", f"use one of {', '.join(known)}")
    if not path.is_file():
        raise UserError(f"there is no file {path}", "shape.file", "paths are relative to the scene's folder")
    file = path.stat()
    state = (file.st_mtime_ns, file.st_size, scripts_trusted())
    return _read(path, state, tuple(spec.layers.items()), spec.tolerance or 0.0)


@lru_cache(maxsize=4)
def _read(
    path: Path, state: tuple[int, int, bool], layers: tuple[tuple[str, str], ...], tolerance: float
) -> ImportedShape:
    """What a file draws, kept while the file is as it is: a command asks for it several times.

    Args:
        path: the file.
        state: when it was written, its size, and whether gmsh runs scripts.
        layers: that are read, with their names; tolerance: of gaps [m].
    """
    found = _readers(state[2])[path.suffix.lower()](path, dict(layers))
    _check(found.curves, path)
    tables, gaps = shape_data(found.curves, path.name, tolerance, found.points)
    return ImportedShape(tables, tuple(gaps), found.notes, found.doubt)


def _readers(trusted: bool) -> dict[str, Reader]:
    """Readers by the endings of files; libraries that one of them needs are imported by it alone."""
    from restshape.shape.drawings.dxf import read_dxf
    from restshape.shape.drawings.geo import read_geo
    from restshape.shape.drawings.step import read_step
    from restshape.shape.drawings.svg import read_svg

    geo: Reader = partial(read_geo, trusted=trusted)
    return {
        ".dxf": read_dxf,
        ".svg": read_svg,
        ".step": read_step,
        ".stp": read_step,
        ".geo": geo,
        ".geo_unrolled": geo,
    }


def _check(loose_curves: list[Curve], path: Path) -> None:
    """Refuses what lies nowhere, and more curves than a shape may have."""
    if len(loose_curves) > OUTLINE_PIECES:
        what = f"the drawing has {len(loose_curves)} curves, more than {OUTLINE_PIECES}"
        raise UserError(what, path.name, "draw less, or read some layers alone: shape.layers")
    for curve in loose_curves:
        if not (np.abs(curve.points).max() <= LENGTH and abs(curve.bulge) <= BULGE):
            what = f"{curve.source} lies farther than {LENGTH:g} m from 0, or is bent too much"
            raise UserError(what, path.name, "check the unit of the drawing ($INSUNITS of .dxf, width of .svg)")
