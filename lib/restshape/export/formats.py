"""Shapes, bodies and meshes in the format that a name says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from restshape.export.cut_drawing import Engraving, cut_drawing
from restshape.export.cut_files import write_cut_dxf, write_cut_svg
from restshape.export.dxf_drawing import write_dxf
from restshape.export.edited_frame import EditedFrame, thickness_of, thickness_over
from restshape.export.frame_mesh import FrameMesh
from restshape.export.mesh_files import write_csv, write_vtu
from restshape.export.step_body import write_step
from restshape.export.stl_surface import write_stl
from restshape.export.svg_drawing import write_svg
from restshape.export.toml_scene import write_toml
from restshape.shape.outline import Outline

FLAT = "without thickness: the materials give none, or not all the same"


def write_shape(kind: str, frame: EditedFrame, mesh: FrameMesh | None, out: Path) -> list[str]:
    """Writes the shape of a frame; what there is to note.

    Args:
        kind: "toml", "dxf", "svg", "step", or "stl", which needs the mesh.
        frame: with the shape; mesh: of the frame; out: the file.

    Raises:
        UserError: this shape has no such file.
        OSError: it cannot be written.
    """
    if kind == "toml":
        return write_toml(frame, out)
    if kind == "dxf":
        left = write_dxf(frame.outline, out)
        return [f"left out, for they share edges with the outline: {', '.join(left)}"] if left else []
    elif kind == "svg":
        write_svg(frame.outline, out)
        return _points_left_out(frame.outline, "a drawing in SVG")
    elif kind == "step":
        thickness = thickness_of(frame.scene)
        write_step(frame.outline, thickness, out)
        left = _points_left_out(frame.outline, "a body in STEP")
        regions = frame.outline.names("region")
        left += [f"left out, for a body in STEP has no regions: {', '.join(regions)}"] if regions else []
        return ([f"a face {FLAT}, or one by a formula"] if thickness is None else []) + left
    else:
        assert mesh is not None, "a surface is that of a mesh"
        return write_mesh(kind, mesh, out, thickness_over(frame.scene, mesh.X) if mesh.flat else None)
    return []


def write_cut(
    kind: str, outline: Outline, kerf: float, engraving: Engraving, unit: str, out: Path
) -> tuple[list[str], float]:
    """Writes a shape for a workshop as "dxf" or "svg"; what there is to note, and the area [m^2].

    Args:
        kind: of both; outline: the shape; kerf: width of the cut [m], or 0; engraving: of its application.
        unit: of lengths in a "dxf"; out: the file.

    Raises:
        UserError: the cut, or a hole that is drilled besides, does not fit into the shape.
        OSError: it cannot be written.
    """
    drawing = cut_drawing(outline, kerf, engraving)
    if kind == "dxf":
        write_cut_dxf(drawing, out, unit)
    else:
        write_cut_svg(drawing, out)
    length, path = 1e3 * drawing.path_length(), f", {500.0 * kerf:g} mm outside of the shape," if kerf else ""
    return [f"the path of the tool{path} is {length:.5g} mm long", *engraving.notes], drawing.shape.area()


def _points_left_out(outline: Outline, what: str) -> list[str]:
    """A note of points inside that a format has no place for."""
    names = [outline.vertex_names[v] for v in outline.embedded]
    return [f"left out, for {what} has no points: {', '.join(names)}"] if names else []


def _cells_left_out(mesh: FrameMesh) -> list[str]:
    """A note of fields that have values a cell, which rows of nodes do not hold."""
    fields = ", ".join(mesh.in_cells)
    return [f"left out, for the rows of a csv are nodes, and these have values a cell: {fields}; vtu has them"] * bool(
        fields
    )


def write_mesh(kind: str, mesh: FrameMesh, out: Path, thickness: float | np.ndarray | None = None) -> list[str]:
    """Writes a mesh with its fields as "vtu" or "csv", or its surface as "stl" or "obj"; what there is to note.

    Args:
        kind: of the four; mesh: of a frame; out: the file.
        thickness: of the body over a plane mesh [m], of all of it or (n,) at its nodes; None: unknown, or none.

    Raises:
        UserError: a body is to be an "obj".
        OSError: it cannot be written.
    """
    if kind == "obj":
        from restshape.export.obj_surface import write_obj

        return write_obj(mesh, out)
    if kind != "stl":
        (write_vtu if kind == "vtu" else write_csv)(mesh, out)
        return _cells_left_out(mesh) if kind == "csv" else []
    write_stl(mesh, thickness, out)
    if mesh.placed is not None:
        return ["the cloth in space: a surface without thickness"]
    if isinstance(thickness, np.ndarray):
        return ["the lower face is flat, the upper one has the formula of the thickness"]
    return [f"a surface {FLAT}"] if mesh.flat and thickness is None else []
