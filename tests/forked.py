"""Commands in processes of their own that begin with all imported: each starts PETSc and MPI for itself."""

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

IMPORTED = ["forked", "restshape.cli.check", "restshape.cli.replay", "restshape.cli.start_notes", "h5py"]
"""What the process imports that all others are forked from."""
PETSC = "petsc4py.PETSc"


def run_forked(
    words: list[str], folder: Path, environment: dict[str, str], seconds: float
) -> subprocess.CompletedProcess:
    """What a command gave that ran in a process of its own in a folder.

    Args:
        words: after ``restshape``.
        environment: all of the variables that the process has.
        seconds: after which it is killed.

    Raises:
        TimeoutError: it was killed.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(IMPORTED)
    files = [folder.parent / f"{folder.name}.{name}" for name in ("printed", "reported")]
    process = context.Process(target=_run, args=(words, folder, environment, files))
    process.start()
    process.join(seconds)
    if process.exitcode is None:
        process.kill()
        process.join()
        raise TimeoutError(f"restshape {' '.join(words)}: no end after {seconds} s")
    out, err = (file.read_text() for file in files)
    return subprocess.CompletedProcess(words, process.exitcode, out, err)


def _run(words: list[str], folder: Path, environment: dict[str, str], files: list[Path]) -> None:
    assert PETSC not in sys.modules, "the process that others are forked from has started PETSc"
    from restshape.cli.main import main

    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    for number, file in enumerate(files, start=1):
        opened = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(opened, number)
        os.close(opened)
    try:
        code = main(words)
    except SystemExit as ended:
        code = int(ended.code or 0)
    # As at the end of an interpreter, where PETSc says what it has to say.
    if PETSC in sys.modules:
        sys.modules[PETSC]._finalize()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
