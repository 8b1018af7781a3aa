"""restshape: simulates an object while its rest shape is being edited.

What it offers programs is in `__init__.pyi`, with types, and is imported where it is first used: `import restshape`
alone imports neither NumPy nor PETSc.
"""

from importlib import import_module

from restshape.early_interrupts import end_at_interrupts

end_at_interrupts()

from restshape.surroundings import ignore_files, use_one_thread  # noqa: E402 (it takes a while)

__version__ = "0.1.0"

use_one_thread()
ignore_files()

OFFERED = {
    "errors": ("UserError",),
    "interface.shown_frame": ("ShownFrame", "ShownMesh"),
    "interface.hand": ("Hand",),
    "interface.opened_recording": ("FrameOnFile", "OpenedRecording", "recording"),
    "interface.run": ("Run",),
    "interface.scenes": ("changed", "load", "new_scene", "save_scene"),
    "interface.scripts": ("load_script", "new_script", "save_script"),
    "interface.simulation": ("RefusedFrame", "Simulation", "open"),
    "live.notebook": ("LivePage",),
    "scene.edit_script": ("Script",),
    "scene.model": ("Scene",),
}
"""Names for programs, by the module that has them."""
CALLED = ("replay", "live")
"""Functions, and the packages of their parts."""
_MODULES = {name: module for module, names in OFFERED.items() for name in names} | {name: name for name in CALLED}


def __getattr__(name: str) -> object:
    """A name that is offered, imported now."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(f"{__name__}.{_MODULES[name]}")
    found = module if name in CALLED else getattr(module, name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """What programs are offered, and what has been imported."""
    return sorted({*globals(), *_MODULES})
