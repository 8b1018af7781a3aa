"""The process of one job: ``python -m restshape_studies.bench.process FILE`` reads it, and writes rows there."""

import json
import os
import resource
import sys
import time
from dataclasses import replace
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any

from restshape_studies.bench.job import Job

from restshape.cli.verbosity import inherit_verbosity
from restshape.errors import ReplayProblem, UserError
from restshape.surroundings import start_petsc


def pin() -> None:
    """Keep this process on one core, where the system lets it."""
    if hasattr(os, "sched_setaffinity"):
        try:
            os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
        except OSError:
            return


def request(job: Job) -> Any:
    """The replay that the job asks for."""
    from restshape.replay.request import Request
    from restshape.scene.edit_script import load_script
    from restshape.scene.load import load_scene

    # Jumps of the mesh cost solves, where some policies have new meshes and others do not.
    scene = load_scene(job.scene, job.overrides if job.estimate else ("solve.jumps=false", *job.overrides))
    script = load_script(job.edits, scene) if job.edits else None
    name, _, guess = job.policy.partition(":")
    return Request.of(scene, script, name, guess or None, petsc=job.petsc, predict=job.predict)


def run_of(job: Job) -> Any:
    """The frames of the job, before the first one."""
    from restshape.interface.run import Run

    # Estimates leave little of the next frame's data in the caches.
    asked = replace(request(job), measured="all" if job.estimate else "residual")
    return Run(asked, summed=False, counted=job.count)


def play(job: Job, report: Any) -> None:
    """Report a row for each frame, as soon as it is computed."""
    run = run_of(job)
    left = {int(level): number for level, number in job.enough.items()}
    begin = time.process_time()
    for frame in islice(run, job.frames):
        row = frame.row
        row["cpu_ms"] = 1e3 * (time.process_time() - begin)
        row["rss_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        if frame.counts:
            row["events"] = frame.counts.events
        report("row", row)
        if row["level"] in left:
            left[row["level"]] -= 1
            if not left[row["level"]]:
                return
        begin = time.process_time()


def measured(job: Job, report: Any) -> None:
    """Report what a module measures, one of this package where its name is not a full one."""
    name = job.measure if "." in job.measure else f"restshape_studies.bench.{job.measure}"
    report("found", import_module(name).measure(request(job), **job.details))


def main() -> int:
    """Run the job on stdin; 0 when it is done, 2 when it cannot be."""
    pin()
    inherit_verbosity()
    job = Job.loads(sys.stdin.read())
    with Path(sys.argv[1]).open("w", buffering=1) as file:

        def report(kind: str, content: Any) -> None:
            file.write(json.dumps([kind, content]) + "\n")

        start_petsc(job.petsc)
        try:
            (measured if job.measure else play)(job, report)
            if job.petsc:
                from restshape.replay.petsc_options import unused

                report("unused", unused(job.petsc))
        except UserError as error:
            report("error", {"what": error.what, "where": error.where, "do": error.do})
            return 2
        except ReplayProblem as problem:
            report("error", {"what": str(problem), "where": job.scene, "do": "see restshape replay on it"})
            return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
