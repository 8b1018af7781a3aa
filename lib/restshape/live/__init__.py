"""Live sessions: a person's hand in a browser drives the simulation that scripts drive."""

import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import cast


class CallableLiveRoom(ModuleType):
    """This package, which is also what `restshape.live(scene)` calls."""

    def __call__(self, *args: object, **keywords: object) -> object:
        """See `restshape.live.notebook.live`."""
        found = import_module(f"{__name__}.notebook").live
        return cast("Callable[..., object]", found)(*args, **keywords)


sys.modules[__name__].__class__ = CallableLiveRoom
