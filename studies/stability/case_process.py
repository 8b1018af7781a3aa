"""Hard cases in their own process: ``python -m restshape_studies.stability.case_process FOLDER PETSC_WORDS...``."""

import json
import sys
import time
from pathlib import Path

from restshape_studies.stability.watched import READY, Telling

from restshape.cli.verbosity import inherit_verbosity
from restshape.surroundings import start_petsc


def main() -> int:
    """Run the cases named on stdin, and report a row for each."""
    inherit_verbosity()
    asked = json.loads(sys.stdin.read())
    folder = Path(sys.argv[1])
    start_petsc(sys.argv[2:])
    from restshape_studies.stability.case import Trial
    from restshape_studies.stability.suite import cases, run_case

    report, known, start = Telling(folder), cases(), time.monotonic()
    report(READY)
    for number, (name, policy) in enumerate(asked["jobs"]):
        if asked["seconds"] is not None and time.monotonic() - start >= asked["seconds"]:
            return 0
        own = folder / str(number)
        own.mkdir()
        report("row", run_case(name, known[name], Trial(own, policy, asked["share"])))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
