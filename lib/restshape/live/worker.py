"""The process of a live session that simulates: it takes the page's messages, and answers with frames.

    python -m restshape.live.worker --link FD SCENE [--edits F] [--out SCRIPT] [--resume] [--record F] ...

Source: docs/live-protocol.md.
"""

import gc
import signal
import sys
from collections.abc import Sequence

from restshape.errors import UserError, printable
from restshape.live.worker_options import options_of
from restshape.replay.recording.recorder_start import begun
from restshape.surroundings import start_petsc


def main(words: Sequence[str]) -> int:
    """Simulates until the server ends the session; 2 where the input is bad."""
    # The server says when it ends: Ctrl-C at a console comes to all processes.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Until the first frame nothing is given back: memory need not be searched for cycles while modules load.
    gc.disable()
    options = options_of(words)
    try:
        # What writes a recording is begun before MPI.
        process = begun() if options.record is not None else None
        start_petsc(options.petsc)
        from restshape.live.live_session import session

        return session(options, process)
    except UserError as error:
        # Other ranks have no link, and say nothing.
        if options.link is not None:
            print(printable(f"restshape live: {error}"), file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
