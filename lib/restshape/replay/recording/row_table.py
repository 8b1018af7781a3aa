"""Rows, of frames or of runs, as a CSV file, written line by line."""

import csv
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from restshape.analysis.analysis import RowValues
from restshape.errors import UserError
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import CsvFile, OutputFile


@contextmanager
def table_of_rows(
    path: Path | None, names: list[str], kind: type[OutputFile] = CsvFile
) -> Iterator[Callable[[RowValues], None] | None]:
    """A function that writes one row to the CSV file, line by line so that none is lost; None without a file.

    Args:
        path: of the file; one of this kind may be replaced.
        names: of the columns.
        kind: what the file is.
    """
    if path is None:
        yield None
        return
    with _user_errors(path):
        refuse_foreign(kind(path), str(path))
        file = path.open("w", newline="", buffering=1)
    writer = csv.DictWriter(file, names, extrasaction="ignore")

    def write(row: RowValues) -> None:
        with _user_errors(path):
            writer.writerow({name: "" if value != value else value for name, value in row.items()})

    try:
        with _user_errors(path):
            writer.writeheader()
        yield write
    finally:
        with _user_errors(path):
            file.close()


@contextmanager
def _user_errors(path: Path) -> Iterator[None]:
    """Turn a failure to write into a user's error."""
    try:
        yield
    except OSError as error:
        raise UserError(
            f"cannot write: {error.strerror}", str(path), "choose a place with room that may be written"
        ) from error
