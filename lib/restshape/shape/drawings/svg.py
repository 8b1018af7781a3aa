"""Outlines from SVG drawings."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import svgelements

from restshape.bounds import DRAWING_BYTES, READING_MEMORY
from restshape.errors import UserError, printable, quoted
from restshape.memory import bounded_memory
from restshape.shape.drawings.layer_names import name_of, refuse_layers, region_named
from restshape.shape.drawings.loose_curve import Curve, LooseCurves, gathered
from restshape.shape.drawings.svg_segments import Placing, curves_of_path
from restshape.shape.drawings.svg_tree import GROUP_NAME, OWN_NAME, REGION_NAME, SvgTree, svg_tree

NO_SIZE = "the drawing has no size in mm, cm, in or pt (width, height), and is read with 96 units an inch"


def read_svg(path: Path, layers: Mapping[str, str]) -> LooseCurves:
    """The curves of an SVG drawing, in metres by its ``width``, ``height`` and ``viewBox``.

    Paths, rectangles, circles, ellipses, lines, polylines and polygons with the transforms of their groups, and copies
    (``use``) of them. The origin is that of the drawing's user units; y of the shape goes up, that of the drawing down.
    Labels or ids name edges and holes, those of groups what has none; a loop that has a group for itself has the name
    of the group. A name that begins with ``region``, or the class ``region``, makes a region. Lines, circle arcs and
    Bézier curves are exact, those that together are one spline an edge, but that Bézier curves which programs draw for
    circles become arcs; arcs of ellipses become splines within `fitted_spline.WITHIN`. What is not displayed, texts,
    images, masks and patterns are left out.

    Args:
        path: the file.
        layers: names by layer, group or shape, where these alone are read; empty: all are.

    Raises:
        UserError: unreadable, or too much.
    """
    if path.stat().st_size > DRAWING_BYTES:
        raise UserError(f"the drawing is longer than {DRAWING_BYTES} bytes", path.name, "draw less")
    with _readable(path):
        tree = svg_tree(path.read_bytes(), path.name)
        refuse_layers(layers, tree.names, path.name)
        root = svgelements.SVG.parse(io.BytesIO(tree.text), reify=False, on_error="raise")
        shapes = [one for one in root.elements() if isinstance(one, svgelements.Shape)] if root is not None else []
        curves = gathered((_curves_of(shape, tree, layers) for shape in shapes), path.name)
    return LooseCurves(curves, doubt="" if tree.sized else NO_SIZE)


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Has whatever is wrong with a drawing that is read within be an error of the user's."""
    do = "save it as plain SVG"
    try:
        with bounded_memory(READING_MEMORY):
            yield
    except UserError as error:
        raise UserError(error.what, error.where or path.name, error.do) from error
    except MemoryError:
        what = f"reading this drawing would take more than {READING_MEMORY >> 30} GB of memory"
        raise UserError(what, path.name, do) from None
    # svgelements lets Python's own errors out, of all kinds, where numbers or words are missing.
    except Exception as error:
        why = printable((str(error).strip() or type(error).__name__).splitlines()[0][:200])
        raise UserError(f"this cannot be read as SVG: {why}", path.name, do) from error


def _curves_of(shape: Any, tree: SvgTree, layers: Mapping[str, str]) -> list[Curve]:
    """The curves of a shape in metres; none where it is not on a layer that is read."""
    groups = [str(text) for key, text in shape.values.items() if key.startswith(GROUP_NAME)]
    own = str(shape.values.get(OWN_NAME) or "")
    chosen = next((layer for layer in (own, *reversed(groups)) if layer in layers), None)
    if layers and chosen is None:
        return []
    loop = name_of(groups[-1]) if groups and chosen is None else ""
    label = name_of(own) or loop if chosen is None else layers[chosen]
    region = name_of(str(shape.values.get(REGION_NAME) or ""))
    if chosen is not None:
        region = label if region or region_named(chosen, label) else ""
    source = f"{type(shape).__name__.lower()} {quoted(printable(own)) if own else 'without an id'}"
    place = Placing.of(shape.transform, tree.scale, source)
    segments = svgelements.Path(shape).segments(transformed=False)
    return [
        replace(piece, label=label, loop=loop, region=region or None, source=source)
        for piece in curves_of_path(segments, place, source)
    ]
