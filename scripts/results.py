"""Makes what is committed under results/, as far as it is of older code. docs/results.md explains it.

python scripts/results.py                    make the stale results
python scripts/results.py --untimed          those of them that hold no times: for a machine that has other work
python scripts/results.py --only plate       those of them whose name holds this word; repeatable
python scripts/results.py --all              make them also where they are not stale
python scripts/results.py --check            list the stale ones and why; exit code 1 if there are any
python scripts/results.py --list             list all, with their files and commands
python scripts/results.py --accept NAME --because "only messages changed"
                                             renew the stamps alone of results that a change is known not to change

A file whose content comes out as it was stays as it was, but for its stamp. Commands whose results hold times are
pinned to the last core that there is (--core K: to another one), but for replays: what records has a core of its own.
"""

from __future__ import annotations

import argparse
import os
import resource
import shlex
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from result_list import LIST, OUTPUTS, RESULTS, Result
from stamps import ROOT, Stamp, code_hash, content_hash, read_stamp, write_stamp

MAIN = "import sys; from restshape.cli.main import main; sys.exit(main())"
SOURCES = ("lib", "apps", "studies", "verification", "tests/physics")


def commit() -> str:
    """The commit that is checked out; "+" where sources were changed since."""
    words = ("git", "-C", str(ROOT))
    head = subprocess.run([*words, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True).stdout.strip()
    changed = subprocess.run([*words, "status", "--porcelain", "--", *SOURCES], capture_output=True, text=True).stdout
    return (head or "unknown") + "+" * bool(changed.strip())


def faults(result: Result, of_this_code: bool = True) -> list[str]:
    """Why a result is stale; none where it is as it was made, and, where asked for, of this code."""
    if not result.paths:
        return ["it was never made"]
    code, found = code_hash(result.entries, result.data) if of_this_code else "", []
    for path in result.paths:
        stamp, name = read_stamp(path), path.relative_to(RESULTS)
        if stamp is None:
            found.append(f"{name} has no stamp")
        elif of_this_code and stamp.code != code:
            found.append(f"{name} is of other code: commit {stamp.commit}")
        elif stamp.content != content_hash(path):
            found.append(f"{name} was changed after it was made")
    return found


def words_of(command: str) -> list[str]:
    """The words that start a command."""
    first, *rest = shlex.split(command)
    if first == "restshape":
        return [sys.executable, "-c", MAIN, *rest]
    return [sys.executable, *(["-m", first] if not first.endswith(".py") else [first]), *rest]


UNPINNED = ("restshape replay", "restshape bench scaling", "restshape bench live")
"""Commands with more than one process at work: what records has a core of its own, as each rank has."""


def pinned(command: str, core: int | None) -> list[str]:
    """The words that start a command, on one core where one is given and it has one process at work."""
    words = words_of(command)
    if core is None or command.startswith(UNPINNED):
        return words
    pin = f"import os, sys; os.sched_setaffinity(0, {{{core}}}); os.execv(sys.argv[1], sys.argv[1:])"
    return [sys.executable, "-c", pin, *words]


def surroundings(core: int | None) -> str:
    """Where times are taken, and beside what, for stamps."""
    load = f"at load {os.getloadavg()[0]:.1f}"
    return load if core is None else f"on core {core} of {os.cpu_count()} {load}"


def last_core() -> int | None:
    """The last of the cores that this process may use; None where the system pins no process."""
    return max(os.sched_getaffinity(0)) if hasattr(os, "sched_setaffinity") else None


def make(result: Result, recorded: set[str], core: int | None = None) -> str:
    """Run the commands of a result and stamp its files; returns what went wrong, or nothing.

    Args:
        result: what to make.
        recorded: replays whose recordings are there already; those of this result are added.
        core: that a result with times is made on; None: any.
    """
    before = {path: path.read_bytes() for path in RESULTS.rglob("*.*") if path.suffix in OUTPUTS}
    contents = {path: content_hash(path) for path in result.paths}
    core = core if result.timed else None
    timed = surroundings(core) if result.timed else ""
    for pattern in result.files:
        (RESULTS / pattern).parent.mkdir(parents=True, exist_ok=True)
    for command in result.commands:
        if command in recorded:
            continue
        paths = os.pathsep.join([str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])
        done = subprocess.run(
            pinned(command, core), cwd=ROOT, env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True
        )
        if done.returncode:
            put_back(before)
            return f"{command}\nends with {done.returncode}:\n{(done.stdout + done.stderr)[-2000:]}"
        if command.startswith("restshape replay"):
            recorded.add(command)
    # A command may write files of other results, too.
    put_back({path: data for path, data in before.items() if path not in result.paths})
    code, now = code_hash(result.entries, result.data), commit()
    # A picture holds the fingerprint of its data: of other data it is another one, even where it looks the same.
    same_data = all(contents.get(path) == content_hash(path) for path in result.paths if path.suffix == ".json")
    for path in result.paths:
        content = content_hash(path)
        if same_data and contents.get(path) == content:
            path.write_bytes(before[path])
        write_stamp(path, Stamp(now, code, content, timed=timed))
    return ""


def put_back(files: dict[Path, bytes]) -> None:
    """Let files hold again what they held."""
    for path, data in files.items():
        if path.read_bytes() != data:
            path.write_bytes(data)


def accept(result: Result, reason: str) -> None:
    """Renew the stamps of a result that a change of the code does not change."""
    code, now = code_hash(result.entries, result.data), commit()
    for path in result.paths:
        known = read_stamp(path) or Stamp(now, code, content_hash(path))
        write_stamp(path, replace(known, code=code, accepted=reason))


def make_all(results: Iterable[Result], core: int | None) -> int:
    """Make results one after the other, those with times on a core; 1 where a command failed."""
    failed, recorded = 0, set[str]()
    for result in results:
        start = _processor_time()
        problem = make(result, recorded, core)
        failed += bool(problem)
        print(f"{'FAILED' if problem else 'made'} {result.name}: {_processor_time() - start:.0f} s of CPU", flush=True)
        if problem:
            print(problem, file=sys.stderr)
    return int(failed > 0)


def _processor_time() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(words: list[str] | None = None) -> int:
    """The exit code: 0, or 1 where something is stale with --check, or a command failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    action = parser.add_mutually_exclusive_group()
    for option in ("check", "list", "all"):
        action.add_argument(f"--{option}", action="store_true")
    action.add_argument("--accept", metavar="NAME")
    parser.add_argument("--because", metavar="REASON")
    parser.add_argument("--untimed", action="store_true")
    parser.add_argument("--core", type=int, default=last_core(), metavar="K")
    parser.add_argument("--only", action="append", default=[], metavar="WORD")
    args = parser.parse_args(words)
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    if args.accept:
        if not args.because or args.accept not in {result.name for result in LIST}:
            parser.error("--accept takes a name of --list, and --because says why")
        accept(next(result for result in LIST if result.name == args.accept), args.because)
        return 0
    wanted = [one for one in LIST if not args.only or any(word in one.name for word in args.only)]
    wanted = [one for one in wanted if not (args.untimed and one.timed)]
    if args.list:
        for one in wanted:
            print(f"{one.name}{' (timed)' if one.timed else ''}: {', '.join(one.files)}")
            print("".join(f"    {command}\n" for command in one.commands), end="")
        return 0
    if args.check:
        stale = {one.name: found for one in wanted if (found := faults(one))}
        print("".join(f"{name}: {'; '.join(found)}\n" for name, found in stale.items()), end="")
        return int(bool(stale))
    # Each is looked at when its turn comes: some are drawn from others.
    return make_all((one for one in wanted if args.all or faults(one)), args.core)


if __name__ == "__main__":
    sys.exit(main())
