"""Hashes each column and field of the recordings of all shipped scenes, and compares them with earlier hashes.

python scripts/recordings.py --write FILE                 replay all, write the hashes (json, or json.gz)
python scripts/recordings.py --write FILE --missing       replay and write those alone that FILE does not have
python scripts/recordings.py --check FILE                 replay all, compare; exit code 1 at a difference
python scripts/recordings.py --check FILE --quick         one script of each application alone
python scripts/recordings.py --check FILE --only solid/   those whose name holds these words; repeatable
python scripts/recordings.py --list                       the replays by name, with what is cut

Each edit script of apps/*/edits is replayed on the scene that its header names, and each scene without a script as it
is, under each policy; one script of each application besides on two ranks and with predicted drags. Long scripts are
cut to their first frames, slow ones replayed with fewer frames an event; --list says which. Each replay runs in a
process of its own, so that none depends on those before it. Times are left out: columns that begin with "ms". Columns
and fields go by their old names where `restshape.replay.columns.ALIASES` (new name to old one) has them. --write with
a selection changes these replays alone in a FILE that is there. Without FILE it is build/recordings.json.gz.
"""

import argparse
import base64
import gzip
import hashlib
import json
import multiprocessing
import os
import shutil
import subprocess
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

import h5py
import numpy as np

USUAL = Path("build/recordings.json.gz")
"""Where hashes are kept if no file is named. They hold on one machine, so none are committed."""
POLICIES = ("rebuild", "refactor", "thesis", "auto")
MOST = 130
"""Frames that a script is cut to where `FRAMES` has no other number."""
MOST_RANKS = 25
"""The same on two ranks, which are slow where others use the cores."""
FRAMES: dict[str, int] = {"bridge": 525, "cantilever": 282, "vibration/building": 200, "solid": 189}
FRAMES |= {"couture/pins thesis": 5, "couture/sphere-drag thesis": 3, "couture/sphere-longer thesis": 3}
THINNED: dict[str, int] = {"couture/pins": 4, "couture/sphere-drag": 4, "couture/sphere-longer": 4}
"""By how much events of scripts are made shorter where each frame is slow: all are kept, in fewer frames each.

Keys are an application, application/script, application/script policy, or a whole name."""
QUICK = ("bridge/bridge", "cantilever/cantilever", "couture/cylinder", "flow/flow", "furniture/table")
QUICK += ("metallophone/fish", "solid/plate", "thermal/fins", "vibration/building")
"""One script of each application: for --quick, and on two ranks too."""
PREDICTED = ("bridge/bridge", "cantilever/cantilever", "metallophone/fish", "solid/plate")
"""Scripts that are predicted too."""
MAIN = "import sys; from restshape.cli.main import main; sys.exit(main())"
PRELOADED = ("restshape.cli.main", "pydantic", "scipy.sparse.linalg", "scipy.spatial", "gmsh")
"""What every replay imports: read once, before its process forks. MPI must not be among them."""
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl": "^uct,openib,ofi",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_mca_base_component_show_load_errors": "0",
}
Entry = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """One replay.

    Args:
        scene: the scene file.
        edits: the edit script; None: the first shape only.
        policy: of reuse.
        ranks: of MPI.
        predict: drags are predicted.
    """

    scene: Path
    edits: Path | None
    policy: str
    ranks: int = 1
    predict: bool = False

    @property
    def script(self) -> str:
        """The application and the script, or the scene where there is none."""
        return f"{self.scene.parent.parent.name}/{(self.edits or self.scene).stem}"

    @property
    def name(self) -> str:
        """What distinguishes it from all others."""
        kind = " 2-ranks" * (self.ranks > 1) + " linear" * self.predict
        return f"{self.script} {self.policy}{kind}"

    @property
    def quick(self) -> bool:
        """Whether --quick replays it."""
        return self.script in QUICK and self.name.endswith(" auto")

    @property
    def whole(self) -> int:
        """How many frames its script has; the first shape is one of them."""
        return frames_of(events(self.edits)) if self.edits else 1

    @property
    def frames(self) -> int:
        """How many of them are replayed."""
        return frames_of(self.shortened()) if self.edits else 1

    @property
    def cut(self) -> str:
        """What is left out."""
        if self.frames == self.whole:
            return f"{self.whole} frames"
        if self.thinned > 1:
            return f"{self.frames} of {self.whole} frames, events in 1/{self.thinned} of their frames"
        return f"first {self.frames} of {self.whole} frames"

    @property
    def thinned(self) -> int:
        """By how much events are made shorter."""
        return self._among(THINNED, 1)

    def _among(self, numbers: dict[str, int], otherwise: int) -> int:
        keys = (self.name, f"{self.script} {self.policy}", self.script, self.script.split("/")[0])
        return next((numbers[key] for key in keys if key in numbers), otherwise)

    def shortened(self) -> list[dict[str, Any]]:
        """The lines of its script, thinned and cut to its frames."""
        header, *rest = events(self.edits)
        kept, left = [header], (self._among(FRAMES, MOST) if self.ranks == 1 else MOST_RANKS) - 1
        for event in rest:
            if left <= 0:
                break
            kept.append(in_fewer(event, min(left, -(-frame_count(event) // self.thinned))))
            left -= frame_count(kept[-1])
        return kept


def events(edits: Path) -> list[dict[str, Any]]:
    """The lines of an edit script, its header first."""
    return [json.loads(line) for line in edits.read_text().splitlines() if line.strip()]


def frames_of(lines: list[dict[str, Any]]) -> int:
    """How many frames the lines of a script have; the first shape is one of them."""
    return 1 + sum(frame_count(event) for event in lines[1:])


def frame_count(event: dict[str, Any]) -> int:
    """How many frames an event takes."""
    return event.get("frames") or len(event.get("path", "."))


def in_fewer(event: dict[str, Any], frames: int) -> dict[str, Any]:
    """The event in so many frames: it gets to its end faster, but for a path, which ends earlier."""
    if frames == frame_count(event):
        return event
    return event | ({"path": event["path"][:frames]} if "path" in event else {}) | {"frames": frames}


def all_jobs(root: Path) -> list[Job]:
    """Every replay of the scenes below root/apps."""
    jobs = []
    for folder in sorted(path.parent for path in root.glob("apps/*/scenes")):
        scripts: dict[str, list[Path]] = {}
        for edits in sorted(folder.glob("edits/*.jsonl")):
            scripts.setdefault(events(edits)[0]["scene"], []).append(edits)
        for scene in sorted(folder.glob("scenes/*.toml")):
            for edits in scripts.get(scene.name, [None]):
                jobs += [Job(scene, edits, policy) for policy in POLICIES]
                auto = jobs[-1]
                jobs += [Job(scene, edits, "auto", ranks=2)] * (auto.script in QUICK)
                jobs += [Job(scene, edits, "auto", predict=True)] * (auto.script in PREDICTED)
    return jobs


# ---- one replay


def words_of(job: Job, folder: Path) -> list[str]:
    """The command line of a replay that records into the folder."""
    words = ["replay", str(job.scene), "--policy", job.policy, "--out", str(folder / "recording.vtkhdf")]
    if job.edits:
        edits = folder / job.edits.name
        edits.write_text("".join(json.dumps(event) + "\n" for event in job.shortened()))
        words += ["--edits", str(edits)]
    return words + ["--predict", "linear"] * job.predict


def run_job(job: Job, folder: Path) -> None:
    """Replay in this process, or on ranks of their own, and leave result.json in the folder."""
    log = os.open(folder / "log", os.O_WRONLY | os.O_CREAT)
    os.dup2(log, 1)
    os.dup2(log, 2)
    words = words_of(job, folder)
    if job.ranks > 1:
        start_words = ["mpiexec", "-n", str(job.ranks), sys.executable, "-c", MAIN]
        code = subprocess.run([*start_words, *words], cwd=folder).returncode
    else:
        os.chdir(folder)
        code = import_module("restshape.cli.main").main(words)
        if "petsc4py.PETSc" in sys.modules:
            sys.modules["petsc4py.PETSc"]._finalize()
    entry: Entry = {"exit": code}
    recording = folder / "recording.vtkhdf"
    if recording.exists():
        with h5py.File(recording) as file:
            entry |= hashes(file)
    times = os.times()
    entry["seconds"] = round(sum(times[:4]), 1)
    (folder / "result.json").write_text(json.dumps(entry))


def aliases() -> dict[str, str]:
    """New names of columns and fields to old ones."""
    with suppress(ImportError):
        return getattr(import_module("restshape.replay.columns"), "ALIASES", {})
    return {}


def hashes(file: h5py.File) -> Entry:
    """The hashes of a recording, with what distinguishes frames."""
    old = aliases()
    table = file["restshape/table"][:]
    names = [name for name in table.dtype.names if name != "checksum" and name != "ms" and not name.startswith("ms_")]
    columns = {old.get(name, name): column(table[name]) for name in names}
    fields = {old.get(name, name): field(arrays) for name, arrays in arrays_of(file["VTKHDF"]).items()}
    return {"frames": len(table), "columns": columns, "fields": fields}


def column(values: np.ndarray) -> Entry:
    """The hash of a column, and all its values."""
    return packed([value.decode(errors="replace") if isinstance(value, bytes) else value for value in values.tolist()])


def field(arrays: Iterator[np.ndarray]) -> Entry:
    """The hash of a field: a check sum of each frame, and its norm."""
    sums, last = [], None
    for array in arrays:
        if array is not last:
            sums.append([zlib.crc32(np.ascontiguousarray(array).data.cast("B")), float(np.sqrt(np.nansum(array**2.0)))])
            last = array
        else:
            sums.append(sums[-1])
    return packed(sums)


def packed(values: list[Any]) -> Entry:
    """The hash of a list, and the list."""
    text = json.dumps(values, separators=(",", ":")).encode()
    return {
        "hash": hashlib.sha256(text).hexdigest()[:16],
        "frames": base64.b64encode(zlib.compress(text, 9)).decode(),
    }


def unpacked(entry: Entry) -> list[Any]:
    """The list of a packed one."""
    return json.loads(zlib.decompress(base64.b64decode(entry["frames"])))


def arrays_of(root: h5py.Group) -> dict[str, Iterator[np.ndarray]]:
    """Each field of a recording by name: an array a frame, the same object where a frame repeats the last one."""
    steps = root["Steps"]
    n = int(steps.attrs["NSteps"])
    part = steps["PartOffsets"][:n]
    counts = {kind: root[f"NumberOf{kind}"][()][part] if n else [] for kind in ("Points", "Cells", "ConnectivityIds")}

    def slices(data: h5py.Dataset, starts: h5py.Dataset, kind: str) -> Iterator[np.ndarray]:
        places = zip(starts[:n].reshape(-1).tolist(), np.asarray(counts[kind]).tolist(), strict=True)
        before = None
        for place in places:
            if place != before:
                values, before = data[place[0] : place[0] + place[1]], place
            yield values

    found = {
        "points": slices(root["Points"], steps["PointOffsets"], "Points"),
        "cells": slices(root["Connectivity"], steps["ConnectivityIdOffsets"], "ConnectivityIds"),
        "cell types": slices(root["Types"], steps["CellOffsets"], "Cells"),
    }
    for group, kind in (("PointData", "Points"), ("CellData", "Cells")):
        for name, data in root[group].items():
            found[name] = slices(data, steps[f"{group}Offsets"][name], kind)
    return found


# ---- all of them


def run_all(jobs: list[Job], cores: int, done: Callable[[Job, Entry], None]) -> None:
    """Replay all, at most one rank a core, and hand on each result as it comes."""
    for name in PRELOADED:
        with suppress(ImportError):
            import_module(name)
    context = multiprocessing.get_context("fork")
    waiting, running = list(jobs), {}
    with tempfile.TemporaryDirectory(prefix="recordings-") as folders:
        while waiting or running:
            used = sum(job.ranks for job, *_ in running.values())
            while waiting and (not running or used + waiting[0].ranks <= cores):
                job = waiting.pop(0)
                folder = Path(tempfile.mkdtemp(dir=folders))
                process = context.Process(target=run_job, args=(job, folder), daemon=True)
                process.start()
                running[process.sentinel] = (job, process, folder)
                used += job.ranks
            for sentinel in wait(list(running)):
                job, process, folder = running.pop(sentinel)
                process.join()
                done(job, result_of(process.exitcode, folder))
                shutil.rmtree(folder)


def result_of(code: int | None, folder: Path) -> Entry:
    """What a replay has left, with the end of what it said where it failed."""
    result = folder / "result.json"
    entry = json.loads(result.read_text()) if result.exists() else {"exit": code or -1, "seconds": 0.0}
    if entry["exit"]:
        entry["said"] = (folder / "log").read_text(errors="replace").strip().splitlines()[-3:]
    return entry


def differences(old: Entry, new: Entry) -> tuple[list[str], list[str]]:
    """What differs between two results of a replay, and what is only to be noted."""
    found, notes = [], []
    if old["exit"] != new["exit"]:
        found.append(f"exit code {new['exit']}, was {old['exit']}: {' / '.join(new.get('said', ()))}")
    if old.get("frames") != new.get("frames"):
        found.append(f"{new.get('frames', 0)} frames, were {old.get('frames', 0)}")
    for kind in ("columns", "fields"):
        before, now = old.get(kind, {}), new.get(kind, {})
        if before and now:
            notes += [f"no {kind[:-1]} {name} any more" for name in before if name not in now]
            notes += [f"new {kind[:-1]} {name}" for name in now if name not in before]
        for name in before:
            if name in now and before[name]["hash"] != now[name]["hash"]:
                found.append(f"{kind[:-1]} {name}: {difference(unpacked(before[name]), unpacked(now[name]))}")
    return found, notes


def difference(old: list[Any], new: list[Any]) -> str:
    """From which frame on two lists differ, in how many, and by how much."""
    # As text, what is not a number equals itself.
    where = [i for i, (a, b) in enumerate(zip(old, new)) if json.dumps(a) != json.dumps(b)]
    if not where:
        return "the same in all frames that both have" if len(old) != len(new) else "the file's own hash is wrong"
    i = where[0]
    text = f"{len(where)} of {len(new)} frames, first in frame {i}"
    if isinstance(new[i], str):
        return f"{text}: {new[i]!r}, was {old[i]!r}"
    pairs = [(a[1], b[1]) if isinstance(a, list) else (a, b) for a, b in ((old[i], new[i]) for i in where)]
    most = max(abs(b - a) / max(abs(a), abs(b)) if a != b else 0.0 for a, b in pairs)
    what = "norms by" if isinstance(new[i], list) else f"{pairs[0][1]!r}, was {pairs[0][0]!r};"
    return f"{text}: {what} at most {most:.1e} relative"


def read(path: Path) -> Entry:
    """The replays of a file."""
    data = path.read_bytes()
    return json.loads(gzip.decompress(data) if path.suffix == ".gz" else data)["replays"]


def write(path: Path, replays: Entry) -> None:
    """Write the file, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"replays": dict(sorted(replays.items()))}, indent=1).encode()
    part = path.with_name(f"{path.name}.part")
    part.write_bytes(gzip.compress(text, mtime=0) if path.suffix == ".gz" else text)
    part.replace(path)


def label(job: Job, entry: Entry) -> str:
    """What is printed of a replay."""
    failed = f", exit {entry['exit']}: {' / '.join(entry.get('said', ()))}" if entry["exit"] else ""
    return f"{job.name}: {job.cut}, {entry['seconds']} s of CPU{failed}"


def write_all(path: Path, jobs: list[Job], cores: int, whole: bool) -> int:
    """Replay and write; the file is whole after each replay."""
    replays = read(path) if path.exists() and not whole else {}

    def done(job: Job, entry: Entry) -> None:
        entry["cut"] = job.cut
        replays[job.name] = entry
        write(path, replays)
        print(label(job, entry), flush=True)

    run_all(jobs, cores, done)
    return 0


def check_all(path: Path, jobs: list[Job], cores: int, whole: bool) -> int:
    """Replay and compare; 1 where something differs."""
    replays = read(path)
    known = [job for job in jobs if job.name in replays]
    known.sort(key=lambda job: (-job.ranks, -replays[job.name]["seconds"]))
    differing: list[str] = []

    def done(job: Job, entry: Entry) -> None:
        found, notes = differences(replays[job.name], entry)
        print(f"{'DIFFERS' if found else 'same   '} {label(job, entry)}", flush=True)
        for line in found:
            print(f"    {line}")
        for line in notes:
            print(f"    note: {line}")
        if found:
            differing.append(job.name)

    run_all(known, cores, done)
    names = {job.name for job in jobs}
    gone = [name for name in replays if name not in names] if whole else []
    for name in gone:
        print(f"DIFFERS {name}: there is no such replay any more")
    for name in sorted(names - set(replays)):
        print(f"note: {name} is new: {path.name} does not have it")
    print(f"{len(known)} replays, {len(differing) + len(gone)} differ")
    return 1 if differing or gone else 0


def main() -> int:
    """The exit code: 1 where something differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--write", type=Path, metavar="FILE", nargs="?", const=USUAL)
    action.add_argument("--check", type=Path, metavar="FILE", nargs="?", const=USUAL)
    action.add_argument("--list", action="store_true")
    parser.add_argument("--only", action="append", default=[], metavar="WORDS", help="replays whose name holds them")
    parser.add_argument("--quick", action="store_true", help="one script of each application, under auto")
    parser.add_argument("--missing", action="store_true", help="with --write: those alone that FILE does not have")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="processes at a time")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[1], help="holds apps/*/scenes")
    args = parser.parse_args()
    os.environ.update(ENVIRONMENT)
    jobs = [job for job in all_jobs(args.root.resolve()) if job.quick or not args.quick]
    if args.only:
        jobs = [job for job in jobs if any(words in job.name for words in args.only)]
    if args.missing and args.write and args.write.exists():
        known = read(args.write)
        jobs = [job for job in jobs if job.name not in known]
    jobs.sort(key=lambda job: -job.ranks)
    if args.list:
        for job in jobs:
            print(f"{job.name}: {job.cut}")
        return 0
    if args.check and not args.check.exists():
        parser.error(f"{args.check} is not there: write it before a change, with --write")
    whole = not (args.only or args.quick or args.missing)
    act = write_all if args.write else check_all
    start = time.perf_counter()
    code = act(args.write or args.check, jobs, args.jobs, whole)
    print(f"{time.perf_counter() - start:.0f} s")
    return code


if __name__ == "__main__":
    sys.exit(main())
