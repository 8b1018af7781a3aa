"""Outlines from Gmsh geometry files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from restshape.errors import UserError
from restshape.shape.drawings.geo_model import curves_of, gmsh_model
from restshape.shape.drawings.geo_process import found_apart
from restshape.shape.drawings.geo_script import draw
from restshape.shape.drawings.geo_tokens import MOST_BYTES
from restshape.shape.drawings.layer_names import refuse_layers
from restshape.shape.drawings.loose_curve import LooseCurves

BOOLEAN = "Boolean"
"""How the names of statements begin that OpenCASCADE may take any time for."""


def read_geo(path: Path, layers: Mapping[str, str] | None = None, trusted: bool = False) -> LooseCurves:
    """The curves of a Gmsh .geo file in metres, through the gmsh package.

    Curves that bound surfaces (all curves where there is no surface) make the loops. A loop that bounds a surface of
    its own is a region. Physical Curve and Surface names become names of edges, groups and regions. Lines and circle
    arcs are exact, other curves become splines within `fitted_spline.WITHIN`.

    Args:
        path: the file.
        layers: of a scene; such a file has none.
        trusted: gmsh runs the whole script, in a process of its own; otherwise only statements that draw are read.

    Raises:
        UserError: unreadable, a statement that is not read, not in the plane, open loops, or too long to read.
    """
    refuse_layers(layers or {}, (), path.name)
    if trusted:
        return found_apart(path, "run")
    text = _text(path)
    if BOOLEAN in text:
        return found_apart(path, "draw")
    with gmsh_model(path) as gmsh:
        draw(gmsh, text, path.name)
        return LooseCurves(curves_of(gmsh.model, path.name))


def _text(path: Path) -> str:
    with path.open("rb") as file:
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise UserError(f"the file is longer than {MOST_BYTES} bytes", path.name, "draw less, or mesh it with gmsh")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UserError("this is not a text file", path.name, "save it as UTF-8") from error
