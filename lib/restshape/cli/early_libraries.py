"""Compiled libraries that are loaded by another thread, while this one imports modules of Python."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from threading import Thread

KERNELS = "restshape._kernels"
"""Brings PETSc, MPI and a hundred libraries of theirs along, whose symbols take as long to bind as 200 modules."""


@contextmanager
def loading_libraries() -> Iterator[None]:
    """Within this the kernels' libraries are loaded, in a thread of its own; afterwards they are there.

    Python lets other threads run while it calls a function of C, which it does not while it imports a library. Before
    this come imports of other compiled modules, for the system loads libraries for one thread at a time.
    """
    spec = None if KERNELS in sys.modules else find_spec(KERNELS)
    if spec is None or spec.origin is None:
        yield
        return
    thread = Thread(target=_load, args=(spec.origin,), name="libraries")
    # Where the system grants no more threads, libraries are loaded as they are imported.
    with suppress(RuntimeError):
        thread.start()
    try:
        yield
    finally:
        if thread.ident is not None:
            thread.join()


def _load(path: str) -> None:
    """Loads a library; what is wrong with it is said where it is imported."""
    import ctypes

    program = ctypes.CDLL(None)
    program.dlopen.argtypes, program.dlopen.restype = (ctypes.c_char_p, ctypes.c_int), ctypes.c_void_p
    program.dlopen(os.fsencode(path), sys.getdlopenflags())
