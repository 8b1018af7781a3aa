"""restshape: simulates an object while its rest shape is being edited."""

from restshape.surroundings import ignore_files, use_one_thread

__version__ = "0.1.0"

use_one_thread()
ignore_files()
