"""Replays: the frame loop and the recorder. The recorder's modules never import PETSc; `loop` does."""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class CallableRoom(ModuleType):
    """This package, which is also what `restshape.replay(scene, script)` calls."""

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        """See `restshape.interface.simulation.replay`."""
        # It is above this package, and imported where it is called.
        return import_module("restshape.interface.simulation").replay(*args, **keywords)


sys.modules[__name__].__class__ = CallableRoom
