"""restshape: simulates an object while its rest shape is being edited."""

from restshape.surroundings import ignore_files

__version__ = "0.1.0"

ignore_files()
