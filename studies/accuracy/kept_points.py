"""Points and references of a study that was stopped, in files, so that the same command goes on from there."""

import hashlib
import json
import shutil
from dataclasses import asdict
from pathlib import Path
from typing import Any

from restshape_studies.accuracy.front import finite
from restshape_studies.accuracy.reference import Plan
from restshape_studies.bench.job import STOPPED

from restshape import __version__
from restshape.outputs.si_numbers import counted

Row = dict[str, Any]

COLUMNS = (
    *("scene", "name", "size", "size_factor", "order", "policy", "tolerance", "varied", "measure", "error"),
    *("error_median", "uncertainty", "frame_ms", "total_s", "unknowns", "elements", "problem"),
)
"""Of the table that --csv writes: keys of a point that hold one value."""


class KeptPoints:
    """What a study has found so far, in a folder that is removed when it has all.

    Args:
        folder: for it alone; what is there of another study is removed.
        question: all that points and references depend on, but for the time that they may take.
    """

    def __init__(self, folder: Path, question: dict[str, Any]) -> None:
        self.folder, self._points = folder, folder / "points.jsonl"
        text = json.dumps([__version__, question], sort_keys=True, default=str)
        key, known = hashlib.sha256(text.encode()).hexdigest(), folder / "question"
        if not known.is_file() or known.read_text() != key:
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            known.write_text(key)
        self.records: dict[str, Row] = {}
        for line in self._points.read_text().split("\n")[:-1] if self._points.is_file() else []:
            record = json.loads(line)
            # What had too little time may have more now.
            if not str(record["problem"]).startswith(STOPPED):
                self.records[record["name"]] = record

    def add(self, record: Row) -> None:
        """Keeps a point."""
        with self._points.open("a") as file:
            file.write(json.dumps(finite(record)) + "\n")

    def reference(self, plan: Plan) -> tuple[Row, Row] | None:
        """What the processes of the reference and of the coarser one reported; None where they have not both ended."""
        path = self.folder / "reference.json"
        if not path.is_file():
            for name in ("fine", "coarse"):
                shutil.rmtree(self.folder / name, ignore_errors=True)
            return None
        known = json.loads(path.read_text())
        return (known["fine"], known["coarse"]) if known["plan"] == json.loads(json.dumps(asdict(plan))) else None

    def keep_reference(self, plan: Plan, fine: Row, coarse: Row) -> None:
        """Keeps what both reported, beside the fields that they wrote into the folder."""
        text = json.dumps({"plan": asdict(plan), "fine": fine, "coarse": coarse})
        (self.folder / "reference.json").write_text(text)

    def words(self) -> str:
        """What is kept of a study that is interrupted, and that the same command goes on."""
        points = len(self._points.read_text().split("\n")) - 1 if self._points.is_file() else 0
        if not (self.folder / "reference.json").is_file():
            return "interrupted before the reference was known: nothing is kept"
        kept = f"the reference and {counted(points, 'point')}" if points else "the reference"
        return f"interrupted; kept in {self.folder}: {kept}; the same command goes on from there"

    def stopped(self) -> None:
        """The study ends early: without a reference nothing is kept."""
        if not (self.folder / "reference.json").is_file():
            self.done()

    def done(self) -> None:
        """The study has all: nothing is kept."""
        shutil.rmtree(self.folder, ignore_errors=True)
