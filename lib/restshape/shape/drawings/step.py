"""Outlines from STEP files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from restshape.bounds import DRAWING_BYTES
from restshape.errors import UserError
from restshape.shape.drawings.geo_process import found_apart
from restshape.shape.drawings.layer_names import refuse_layers
from restshape.shape.drawings.loose_curve import LooseCurves

BEGINNING = b"ISO-10303-21"
SEARCHED = 4096
"""Bytes among which a STEP file begins."""


def read_step(path: Path, layers: Mapping[str, str]) -> LooseCurves:
    """The curves of a STEP file in metres by its header, through gmsh's OpenCASCADE in a process of its own.

    Those around the largest plane face, and around all others in its plane; of a plate these are one of its two sides.
    A face whose whole border is part of another face's is a region. Lines and circle arcs are exact, other curves
    become splines within `fitted_spline.WITHIN`.

    Args:
        path: the file.
        layers: of a scene; such a file has none.

    Raises:
        UserError: unreadable, without a plane face, or too long to read.
    """
    refuse_layers(layers, (), path.name)
    if path.stat().st_size > DRAWING_BYTES:
        raise UserError(f"the drawing is longer than {DRAWING_BYTES} bytes", path.name, "export the part alone")
    with path.open("rb") as file:
        if BEGINNING not in file.read(SEARCHED):
            what = f"this is no STEP file: it does not begin with {BEGINNING.decode()}"
            raise UserError(what, path.name, "export it as STEP from your CAD program")
    return found_apart(path, "step")
