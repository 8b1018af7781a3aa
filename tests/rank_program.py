"""Run by mpiexec: each rank takes command lines from a socket of the tests and answers with what it has printed."""

import json
import os
import socket
import sys
import tempfile
import traceback
from contextlib import ExitStack

from restshape.cli.main import main
from restshape.cli.ranks import first_rank


def exit_code(words: list[str]) -> int:
    """The exit code of a command line."""
    try:
        return main(words)
    except SystemExit as ended:
        return int(ended.code or 0)
    except BaseException:
        traceback.print_exc()
        return 1


def run(words: list[str], folder: str) -> dict:
    """The exit code of a command line in a folder, and all that was printed, be it by Python or by a library."""
    os.chdir(folder)
    with ExitStack() as stack:
        files = [stack.enter_context(tempfile.TemporaryFile("w+")) for _ in (1, 2)]
        kept = [os.dup(number) for number in (1, 2)]
        for number, file in zip((1, 2), files):
            os.dup2(file.fileno(), number)
        try:
            code = exit_code(words)
        finally:
            for number, stream, old in zip((1, 2), (sys.stdout, sys.stderr), kept):
                stream.flush()
                os.dup2(old, number)
                os.close(old)
        for file in files:
            file.seek(0)
        return {"code": code, "out": files[0].read(), "err": files[1].read()}


def serve(path: str) -> None:
    """Answer until the tests hang up. Ranks wait here, not in MPI, where they would keep their cores busy."""
    with socket.socket(socket.AF_UNIX) as link:
        link.connect(path)
        with link.makefile("rw") as lines:
            print(json.dumps({"first": first_rank()}), file=lines, flush=True)
            for line in lines:
                print(json.dumps(run(**json.loads(line))), file=lines, flush=True)


if __name__ == "__main__":
    try:
        serve(sys.argv[1])
    except OSError:
        # The tests have given up, and the other rank may wait for this one.
        os._exit(1)
