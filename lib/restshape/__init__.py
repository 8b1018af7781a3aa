"""restshape: simulates an object while its rest shape is being edited."""

from restshape.early_interrupts import end_at_interrupts

end_at_interrupts()

from restshape.surroundings import ignore_files, use_one_thread  # noqa: E402 (it takes a while)

__version__ = "0.1.0"

use_one_thread()
ignore_files()
