"""Files that a program asks for, written whole."""

from pathlib import Path

from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole


def save_text(path: Path, text: str, force: bool) -> None:
    """Writes a text into a file, whole or not at all.

    Args:
        path: of the file; text: what it will hold; force: replace a file that is there.

    Raises:
        UserError: there is a file already, or it cannot be written.
    """
    if path.exists() and not force:
        raise UserError("there is a file of this name already", str(path), "name another one, or say force=True")
    try:
        write_whole(path, text)
    except OSError as error:
        what = f"it cannot be written: {(error.strerror or str(error)).lower()}"
        raise UserError(what, str(path), "name another file") from error
