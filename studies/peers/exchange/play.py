"""Plays a case with one program of a peer, in the peer's own Python.

python play.py PROGRAMS WAY CASE ANSWERS

PROGRAMS is the folder of the peer's programs and WAY one of them, "documented" or "tuned". Its `PROBLEMS` has a class
for each problem that the peer can do: made from a mesh and parameters, it gives the answer on moved places by
`frame(points)`; `NOT_DONE` says why it cannot do others. Where it does not come to the accuracy that is asked for, its
`short` says so. A program with a function `play` times itself. CASE is read, and ANSWERS is written: ``answers.npz``
with an array a frame, ``times.json`` with seconds of the clock and of the processor.
"""

import json
import resource
import sys
import time
from importlib import import_module
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from handed import HandedCase, read_case


def play(kind: type, case: HandedCase) -> tuple[list, list, list, str]:
    """Answers of all frames, with their seconds of the clock and of the processor; a new mesh makes a new object.

    The last one says what the last answer falls short of, if anything.
    """
    answers, seconds, processor = [], [], []
    solver, last = None, -1
    for number, points in zip(case.mesh_of, case.places):
        clock, used = time.perf_counter(), time.process_time()
        if number != last:
            solver, last = kind(case.meshes[number], case.parameters), number
        answer = solver.frame(points)
        seconds.append(time.perf_counter() - clock)
        processor.append(time.process_time() - used)
        answers.append(np.array(answer))
    return answers, seconds, processor, getattr(solver, "short", "")


def main(programs: str, way: str, case_folder: str, answer_folder: str) -> int:
    """Play, and write answers and times; 0, or 4 where the peer has no such problem."""
    sys.path.insert(0, programs)
    program, case, folder = import_module(way), read_case(Path(case_folder)), Path(answer_folder)
    kind = program.PROBLEMS.get(case.problem)
    if kind is None:
        print(getattr(program, "NOT_DONE", {}).get(case.problem, "there is no program for it"), file=sys.stderr)
        return 4
    answers, seconds, processor, *short = getattr(program, "play", play)(kind, case)
    np.savez(folder / "answers.npz", **{f"answer_{k}": answer for k, answer in enumerate(answers)})
    who = resource.RUSAGE_CHILDREN if hasattr(program, "play") else resource.RUSAGE_SELF
    found = {"seconds": seconds, "processor": processor, "peak_mb": resource.getrusage(who).ru_maxrss / 1024}
    (folder / "times.json").write_text(json.dumps(found | {"version": program.VERSION, "short": "".join(short)}))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
