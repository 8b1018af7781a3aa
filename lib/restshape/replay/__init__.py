"""Replays: the frame loop and the recorder. The recorder's modules never import PETSc; `loop` does."""

import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import cast


class CallableRoom(ModuleType):
    """This package, which is also what `restshape.replay(scene, script)` calls."""

    def __call__(self, *args: object, **keywords: object) -> object:
        """See `restshape.interface.replays.replay`."""
        # It is above this package, and imported where it is called.
        found = import_module("restshape.interface.replays").replay
        return cast("Callable[..., object]", found)(*args, **keywords)


sys.modules[__name__].__class__ = CallableRoom
