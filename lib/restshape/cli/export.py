"""`restshape export`: the edited shape, its mesh and its fields as files of other programs, and as a scene."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.cli.export_for_workshop import (
    add_workshop,
    check_workshop,
    engraving_of,
    for_workshop,
    own_formats,
    refuse_format,
    shaped_by_application,
    write_own,
)
from restshape.cli.options import add_json, add_set, refuse_files_of_scene, write_json
from restshape.cli.parser import add_edits
from restshape.errors import UserError, one_line
from restshape.outputs.claims import refuse_outputs
from restshape.outputs.kinds import ExportFile

if TYPE_CHECKING:
    from restshape.export.edited_frame import EditedFrame
    from restshape.export.frame_mesh import FrameMesh
    from restshape.export.restated_frame import RestatedFrame

SUMMARY = "the edited shape as toml, dxf, svg or step, mesh and fields as stl, obj, vtu or csv, a bar as pdf or wav"
KINDS = ("toml", "dxf", "svg", "step", "stl", "obj", "vtu", "csv")
OF_MESH = ("obj", "vtu", "csv")
"""Formats that a recording's mesh and fields are enough for."""
RECORDING = ".vtkhdf"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    parser.add_argument("source", metavar="RECORDING|SCENE", type=Path, help="recording (.vtkhdf), or scene (.toml)")
    parser.add_argument(
        "--as", dest="kind", choices=(*KINDS, *own_formats()), required=True, help="format of the file to write"
    )
    add_edits(parser, "edit script (.jsonl) of a scene")
    parser.add_argument(
        "--frame", metavar="N", type=int, default=-1, help="from 0, or from -1 backwards (default: the last one)"
    )
    parser.add_argument(
        "--out", metavar="FILE", type=ExportFile, help="file to write (default: the scene's name, beside the input)"
    )
    add_workshop(parser)
    add_set(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Writes the file and says what it shows; the exit code."""
    check_workshop(args)
    result = (_of_recording if args.source.suffix == RECORDING else _of_scene)(args)
    row, count, t = result["frame"], result["frames"], result["t"]
    print(f"wrote {one_line(result['file'])}: frame {row} of {count} (0 to {count - 1}), t = {t:.3f} s")
    for note in result["notes"]:
        print(f"note: {note}")
    write_json(args, result)
    return 0


def _of_recording(args: argparse.Namespace) -> dict[str, Any]:
    """Exports a frame of a recording."""
    for option, given in (("EDITS", args.edits), ("--set", args.set)):
        if given:
            what = "a recording has its own scene and edits"
            raise UserError(what, option, "leave it out, or name the scene instead of the recording")
    from restshape.cli.report import refuse_damage
    from restshape.export.edited_frame import frame_of_recording, row_of, scene_of
    from restshape.export.frame_mesh import mesh_of_recording
    from restshape.export.restated_frame import restated_of_recording, restates
    from restshape.replay.recording.recording import Recording

    with Recording(args.source) as recording:
        if not recording.n:
            raise UserError("the recording holds no frames", str(args.source), "run the replay again")
        refuse_damage(recording)
        row = row_of(args.frame, recording.n, "the recording")
        out = _out(args, str(recording.header.get("scene") or args.source.name))
        mesh = mesh_of_recording(recording, row) if args.kind in (*OF_MESH, "stl") else None
        if mesh is not None and (args.kind in OF_MESH or not mesh.flat):
            refused = str(recording.table["refused"][row]) if "refused" in recording.table else ""
            notes = _write_mesh(args.kind, mesh, out)
            return _result(args, out, (row, recording.n, float(recording.times[row])), refused, notes)
        if args.kind == "toml" and restates(scene_of(recording)):
            return _restated(args, restated_of_recording(recording, row), out)
        return _written(args, frame_of_recording(recording, row), mesh, out)


def _of_scene(args: argparse.Namespace) -> dict[str, Any]:
    """Exports a frame of a script, or the first shape of a scene."""
    from restshape.export.edited_frame import frame_of_script
    from restshape.export.frame_mesh import mesh_of_shape
    from restshape.export.restated_frame import restated_of_script, restates
    from restshape.scene.edit_script import Script, load_script
    from restshape.scene.load import load_scene

    scene = load_scene(args.source, args.set)
    args.out = out = _out(args, args.source.name)
    refuse_files_of_scene(args, scene)
    script = load_script(args.edits, scene) if args.edits else Script.empty(scene)
    try:
        if args.kind == "toml" and restates(scene):
            return _restated(args, restated_of_script(scene, script, args.frame), out)
        frame = frame_of_script(scene, script, args.frame)
    except UserError as error:
        raise scene.located(error) from None
    if args.kind not in (*OF_MESH, "stl"):
        return _written(args, frame, None, out)
    mesh = mesh_of_shape(frame.scene, frame.outline)
    if args.kind == "stl":
        return _written(args, frame, mesh, out)
    notes = [*_write_mesh(args.kind, mesh, out), "the mesh alone: a recording has the fields (restshape replay --out)"]
    return _result(args, out, (frame.row, frame.count, frame.t), frame.refused, notes)


def _restated(args: argparse.Namespace, frame: RestatedFrame, out: ExportFile) -> dict[str, Any]:
    """Writes a scene without an outline; what has been written."""
    return _result(args, out, (frame.row, frame.count, frame.t), frame.refused, _writing(out, lambda: frame.write(out)))


def _out(args: argparse.Namespace, scene: str) -> ExportFile:
    """The file to write, which destroys nothing of the user's.

    Raises:
        UserError: it would.
    """
    if args.out is not None and args.out.suffix.lower() != f".{args.kind}":
        remedy = f"--out {args.out.with_suffix('.' + args.kind)}, or --as of another format"
        raise UserError(f"the name of a {args.kind} file ends in .{args.kind}", f"--out {args.out}", remedy)
    stem = f"{Path(scene).stem}-edited" if args.kind == "toml" else Path(scene).stem
    out: ExportFile = args.out or ExportFile(args.source.with_name(f"{stem}.{args.kind}"))
    inputs = {f"source {args.source}": args.source} | ({f"edits {args.edits}": args.edits} if args.edits else {})
    refuse_outputs({"--out": out}, inputs)
    if out.is_dir():
        raise UserError("this is a folder", f"--out {out}", "name a file in it")
    return out


def _written(args: argparse.Namespace, frame: EditedFrame, mesh: FrameMesh | None, out: Path) -> dict[str, Any]:
    """Writes a shape, its surface, or what its application makes of it; what has been written."""
    from restshape.export.formats import write_cut, write_shape
    from restshape.export.frame_mesh import mesh_of_shape

    refuse_format(args.kind, frame.scene)
    area = frame.outline.area()
    if args.kind in own_formats():
        notes = _writing(out, lambda: write_own(args, frame, out))
    elif for_workshop(args, frame.scene):
        engraving = engraving_of(args, frame)
        drawn: tuple[list[str], float] = _writing(
            out, lambda: write_cut(args.kind, frame.outline, args.kerf, engraving, args.unit or "mm", out)
        )
        notes, area = drawn
    else:
        shaped, said = shaped_by_application(args, frame)
        if shaped is not frame and mesh is not None:
            mesh = mesh_of_shape(shaped.scene, shaped.outline)
        notes = [*_writing(out, lambda: write_shape(args.kind, shaped, mesh, out)), *said]
        area = shaped.outline.area()
    return _result(args, out, (frame.row, frame.count, frame.t), frame.refused, notes) | {"area": area}


def _write_mesh(kind: str, mesh: FrameMesh, out: Path) -> list[str]:
    """Writes a mesh and its fields; what there is to note."""
    from restshape.export.formats import write_mesh

    return _writing(out, lambda: write_mesh(kind, mesh, out))


def _writing(out: Path, write: Any) -> Any:
    """What a writer notes.

    Raises:
        UserError: the file cannot be written.
    """
    try:
        return write()
    except OSError as error:
        what = f"{out} cannot be written: {(error.strerror or str(error)).lower()}"
        raise UserError(what, "--out", "name another file") from error


def _result(
    args: argparse.Namespace, out: Path, place: tuple[int, int, float], refused: str, notes: list[str]
) -> dict[str, Any]:
    """What has been written, for programs."""
    row, count, t = place
    why = [f"frame {row} was refused ({refused.splitlines()[0]}): this is the shape before it"] if refused else []
    named = {"file": str(out), "format": args.kind, "frame": row, "frames": count, "t": t}
    return named | {"refused": refused, "notes": [*why, *notes]}
