"""The kinds of files that commands write, as types of options; each knows a file of its own that is there already."""

import os
import re
import stat
import struct
from pathlib import Path, PosixPath
from typing import BinaryIO
from zlib import crc32

HEAD = 1 << 16
"""Bytes of a file that are looked at."""
SIGNED = "written by restshape script, "
"""Beginning of the note in the first line of such a script; what follows it is the CRC-32 of all other lines."""
PICTURE_MARK = "restshape"
"""Beginning of `Software` in the texts of a picture."""
SCENE_MARK = "# written by restshape accuracy --write\n"


class OutputFile(PosixPath):
    """A path of an option that names a file to write; what other paths of a command name is read."""

    what = "a file that restshape has written"
    noun = "a file"
    endings: tuple[str, ...] = ()
    """How names of such files end, of which one is a must; none: as the user likes."""

    def ours(self) -> bool:
        """Whether restshape may replace what is there: nothing, an empty file, a device, or a file of this kind.

        Raises:
            OSError: it cannot be read.
        """
        try:
            found = self.stat()
        except (FileNotFoundError, NotADirectoryError):
            return True
        if not stat.S_ISREG(found.st_mode) or not found.st_size:
            return True
        with self.open("rb") as file:
            return self.known(file.read(HEAD))

    def known(self, head: bytes) -> bool:
        """Whether a file that begins like this is of this kind."""
        return False


class JsonFile(OutputFile):
    """A result for programs: a table or list of JSON, one more space a level, as no other program is used to."""

    what = "a result that --json wrote"

    def known(self, head: bytes) -> bool:
        """Whether it is laid out as `--json` lays it out."""
        return re.match(rb'(\{\}|\[\]|\{\n "|\[\n [^\s])', head) is not None


class PointsFile(OutputFile):
    """The points of studies, a row each."""

    what = "a table of points that accuracy --csv wrote"

    def known(self, head: bytes) -> bool:
        """Whether it begins with the columns that such tables have."""
        return head.startswith(b"scene,name,size,")


class CsvFile(OutputFile):
    """The rows of a replay."""

    what = "a table that --csv wrote"

    def known(self, head: bytes) -> bool:
        """Whether it has the columns that all replays have."""
        return head.startswith(b"index,line,level,flips,")


class SweepFile(OutputFile):
    """The rows of a sweep."""

    what = "a table that sweep --csv wrote"

    def known(self, head: bytes) -> bool:
        """Whether it has the columns that all sweeps have."""
        return head.startswith(b"run,status,frames,refused,")


TABLE_MARK = "# written by restshape "
"""Beginning of the first line of a made record; what follows it says of what."""
TABLE_HEADS = rb"damping,period \[s\],|mode,frequency \[Hz\],|frequency \[Hz\],[^,\n]+ \[m\],[^,\n]+_phase \[deg\],"
"""First columns of a spectrum, of modes, and of a harmonic response."""


class TableFile(OutputFile):
    """A table (CSV) of a spectrum, of modes, of a harmonic response, or a made record, which says so."""

    what = "a table that restshape wrote"

    def known(self, head: bytes) -> bool:
        """Whether it has the columns of one, or says so in its first line."""
        return head.startswith(TABLE_MARK.encode()) or re.match(TABLE_HEADS, head) is not None


class RecordingFile(OutputFile):
    """A recording, whole or damaged."""

    what = "a recording of restshape"

    def known(self, head: bytes) -> bool:
        """Whether it is HDF5 with the groups of a recording: their names are in its first bytes."""
        return head.startswith(b"\x89HDF\r\n\x1a\n") and b"restshape\0" in head and b"VTKHDF\0" in head


class ScriptFile(OutputFile):
    """An edit script that nobody has changed since `restshape script` wrote it."""

    what = "a script that restshape script wrote and nobody changed"

    def ours(self) -> bool:
        """As of all files, but the whole of it counts."""
        return not self.is_file() or not self.stat().st_size or _signature_holds(self)


class LiveScriptFile(OutputFile):
    """The script of a live session; the command refuses what is there already, unless it may be replaced."""

    what = "an edit script"
    noun = "a script"
    endings = (".jsonl",)

    def known(self, head: bytes) -> bool:
        """Whether it begins as scripts do."""
        return head.startswith((b'{"format": "restshape-edits"', b'{"format":"restshape-edits"'))


class SchemaFile(OutputFile):
    """A JSON schema of scenes or scripts."""

    what = "a schema that restshape schema wrote"

    def known(self, head: bytes) -> bool:
        """Whether it begins as ours, in their layout."""
        return head.startswith(b'{\n "$schema": "https://json-schema.org/draft/2020-12/schema",\n "title": "')


class SceneFile(OutputFile):
    """A scene that `accuracy --write` made."""

    what = "a scene that accuracy --write wrote"

    def known(self, head: bytes) -> bool:
        """Whether it says so in its first line."""
        return head.startswith(SCENE_MARK.encode())


FITTED_MARK = "# written by restshape fit\n"


class FittedFile(OutputFile):
    """A scene that `restshape fit` made."""

    what = "a scene that restshape fit wrote"

    def known(self, head: bytes) -> bool:
        """Whether it says so in its first line."""
        return head.startswith(FITTED_MARK.encode())


TUNED_MARK = "# written by restshape tune\n"


class TunedFile(OutputFile):
    """A scene that `restshape tune` made."""

    what = "a scene that restshape tune wrote"

    def known(self, head: bytes) -> bool:
        """Whether it says so in its first line."""
        return head.startswith(TUNED_MARK.encode())


EXPORT_MARK = "written by restshape export"
"""In the first bytes of every exported file, but for tables."""
EXPORT_HEADS = "node,x,y"
"""First columns of an exported table."""


SHEET_MARK = "restshape export"
"""The program that a PDF of a sheet says it was made by."""


class ExportFile(OutputFile):
    """A shape, a scene, a mesh, a table, a sheet or a sound that `restshape export` wrote."""

    what = "a file that restshape export wrote"
    maker = SHEET_MARK

    def known(self, head: bytes) -> bool:
        """Whether it has the mark of exports, or the columns of an exported table."""
        return EXPORT_MARK.encode() in head or head.startswith(EXPORT_HEADS.encode())

    def ours(self) -> bool:
        """As of other files; a PDF and a sound say at their ends who made them."""
        if not self.is_file():
            return super().ours()
        with self.open("rb") as file:
            head = file.read(5)
            if head == b"%PDF-":
                return f"/Creator ({self.maker})".encode() in file.read()
            return SoundFile(self).ours() if head.startswith(b"RIFF") else super().ours()


PATTERN_MARK = "restshape pattern"
"""The program that a PDF of a pattern says it was made by."""


class PatternFile(ExportFile):
    """A pattern: a drawing, a scene or a file of another program, or a PDF in true size."""

    what = "a pattern that restshape wrote"
    maker = PATTERN_MARK


BODY_MARK = "written by restshape mannequin"
"""In the first line of every surface of a body."""


class BodyFile(OutputFile):
    """The surface of a body that `restshape mannequin` wrote."""

    what = "a body that restshape mannequin wrote"

    def known(self, head: bytes) -> bool:
        """Whether it says so in its first line."""
        return head.startswith(f"# {BODY_MARK}".encode())


class PageFile(OutputFile):
    """A page of results in Markdown."""

    what = "a page that restshape wrote"

    def known(self, head: bytes) -> bool:
        """Whether it names the command that wrote it."""
        return head.startswith(b"# ") and (b"\n```sh\nrestshape " in head or b"Written by `restshape tables`" in head)


JOB_SCRIPT_MARK = "# written by restshape bench scaling"
"""In the second line of every such script."""


class JobScriptFile(OutputFile):
    """A job script of a cluster."""

    what = "a job script that restshape bench scaling wrote"
    noun = "a job script"

    def known(self, head: bytes) -> bool:
        """Whether it says so in its second line."""
        return head.startswith(f"#!/bin/bash\n{JOB_SCRIPT_MARK}".encode())


PICTURES = (".png", ".svg")
"""Suffixes of still pictures."""


class PictureFile(OutputFile):
    """A picture (PNG or SVG) that says which program drew it."""

    what = "a picture that restshape drew"
    noun = "a picture"
    endings = PICTURES

    def known(self, head: bytes) -> bool:
        """Whether `outputs.picture_files` has marked it."""
        if head.startswith(b"<?xml"):
            return b"<dc:title>" + PICTURE_MARK.encode() in head
        return head.startswith(b"\x89PNG\r\n\x1a\n") and b"tEXtSoftware\0" + PICTURE_MARK.encode() in head


class PeriodFile(OutputFile):
    """An animation (GIF) of a mode that says in its comment which program drew it."""

    what = "an animation of a mode that restshape drew"
    noun = "an animation"
    endings = (".gif",)

    def known(self, head: bytes) -> bool:
        """Whether it has the comment of such animations."""
        comment = PICTURE_MARK.encode()
        return head.startswith(b"GIF89a") and b"\x21\xfe" + bytes([len(comment)]) + comment + b"\0" in head


class AnimationFile(OutputFile):
    """An animation in a folder of a report."""

    what = "an animation in a folder of restshape report"

    def known(self, head: bytes) -> bool:
        """Whether the folder is that of a report, in which each has a timeline."""
        timelines = [PictureFile(self.with_name(f"timeline{suffix}")) for suffix in PICTURES]
        return any(timeline.is_file() and timeline.ours() for timeline in timelines)


class SoundFile(OutputFile):
    """A sound (WAV) that says in its last chunk which program wrote it."""

    what = "a sound that restshape wrote"
    noun = "a sound"
    endings = (".wav",)

    def ours(self) -> bool:
        """As of all files, but the end of it counts."""
        if not self.is_file() or not self.stat().st_size:
            return True
        with self.open("rb") as file:
            file.seek(max(0, self.stat().st_size - 64))
            return file.read().endswith(SOUND_MARK)


SOUND_MARK = b"LIST\x16\0\0\0INFOISFT\x0a\0\0\0restshape\0"
"""A chunk of RIFF that names the program."""


def signed(text: str) -> str:
    """An edit script whose first line says that nobody has changed the others."""
    first, _, rest = text.partition("\n")
    return f'{first.removesuffix("}")}, "note": "{SIGNED}{crc32(rest.encode()):08x}"}}\n{rest}'


def _signature_holds(path: Path) -> bool:
    with path.open("rb") as file:
        first = file.readline(HEAD)
        found = re.search(SIGNED.encode() + rb"([0-9a-f]{8})\"}\n$", first)
        return bool(found and found[1] == b"%08x" % crc32(file.read()))


def mark_sound(file: BinaryIO) -> None:
    """Appends the program's name to a whole WAV file, open for reading and writing."""
    length = file.seek(0, os.SEEK_END)
    file.write(b"\0" * (length % 2) + SOUND_MARK)
    file.seek(4)
    file.write(struct.pack("<I", length + length % 2 + len(SOUND_MARK) - 8))
