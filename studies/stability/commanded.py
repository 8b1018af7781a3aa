"""Replays by the command itself: what it ends with, and what it writes."""

import csv
import io
import json
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from restshape_studies.stability.example import EDITS, ONTO, RECORDING, SCENE, SUMMARY, TABLE, Example

from restshape.cli.main import main
from restshape.replay.recording.recording import Recording


def command_problem(folder: Path, example: Example, message: str, frames: int, refused: int) -> str:
    """What is wrong with `restshape replay` of an example's files, in words; empty where nothing is.

    Args:
        folder: of the files; for those that the command writes too.
        example: what is replayed, and how.
        message: with which a replay without the command was refused, or ended early; empty where it was not.
        frames: that it had; refused: of these.

    Raises:
        BaseException: whatever a user would see a traceback of.
    """
    for name in (RECORDING, TABLE, SUMMARY):
        (folder / name).unlink(missing_ok=True)
    files = (SCENE, EDITS, RECORDING, TABLE, SUMMARY)
    code, printed = run_command([str(folder / word) if word in files else word for word in example.words])
    if code != (2 if message else 0):
        return f"the command ends with {code}, where the replay said {message or 'nothing'!r}"
    if message and not printed.rstrip().rpartition("restshape replay: ")[2]:
        return "the command ends with 2 and says nothing"
    if "Traceback" in printed:
        return f"the command prints a traceback: {printed[-300:]}"
    return _written(folder, frames, refused) if frames else ""


def overwriting_problem(folder: Path, example: Example) -> str:
    """What is wrong where the command is asked to write over a file of the user's; empty where it refuses.

    Whether files have changed is for the caller to see.
    """
    asked = [word if word.startswith("--") else str(folder / word) for word in ONTO[example.onto]]
    code, printed = run_command(["replay", str(folder / SCENE), "--edits", str(folder / EDITS), *asked])
    if code != 2 or not printed.rstrip().rpartition("restshape replay: ")[2]:
        return f"onto {example.onto}: the command ends with {code}"
    return ""


def run_command(words: list[str]) -> tuple[int, str]:
    """The exit code, and what went to stderr; both streams are as strict with characters as real ones."""
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", errors) for errors in ("strict", "backslashreplace"))
    with redirect_stdout(out), redirect_stderr(err):
        code = main(words)
    err.flush()
    return code, err.buffer.getvalue().decode()


def _written(folder: Path, frames: int, refused: int) -> str:
    """What is wrong with the three files of so many frames."""
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"), parse_constant=_no_number)
    except ValueError as error:
        return f"the JSON file is none: {error}"
    if (summary["frames"], summary["refused"]) != (frames, refused):
        return f"the JSON file has {summary['frames']} frames, {summary['refused']} refused, not {frames}, {refused}"
    with (folder / TABLE).open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file, strict=True))
    if [row["index"] for row in rows] != [str(k) for k in range(frames)] or any(None in row for row in rows):
        return f"the CSV file has {len(rows)} rows, or rows longer than its head"
    with Recording(folder / RECORDING) as recording:
        wrong = recording.verify()
        if wrong or recording.status != "done" or recording.table["index"].tolist() != list(range(frames)):
            return f"the recording ({recording.status}) has {recording.n} of {frames} frames: {wrong}"
    return ""


def _no_number(name: str) -> Any:
    raise ValueError(f"{name} stands where null should")
