"""`restshape validate`: computed values beside references."""

import argparse

from restshape.cli.options import add_json, print_table, write_json
from restshape.cli.verbosity import add_verbose
from restshape.outputs.si_numbers import counted
from restshape.surroundings import start_petsc

PLACE = 2
SUMMARY = "compare computed values with references that restshape did not compute"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--case", action="append", metavar="NAME", help="only this case (may be given several times)")
    parser.add_argument("--list", action="store_true", help="name the cases and stop")
    add_json(parser)
    add_verbose(parser)


def run(args: argparse.Namespace) -> int:
    """Validate; 0 when all checks pass, 1 when one fails."""
    start_petsc(args.petsc)
    from petsc4py import PETSc
    from restshape_studies.verification import check_cases, verifications

    comm = PETSc.COMM_WORLD
    known = {
        f"{app}.{name}": case
        for app, found in verifications().items()
        for name, case in found.load_validation().items()
    }
    if args.list:
        print("\n".join(f"{name}: {(case.__doc__ or '').splitlines()[0]}" for name, case in known.items()))
        return 0
    check_cases(args.case or [], known, f"use one of: {', '.join(known)}")
    rows = [check.as_dict(name) for name in args.case or known for check in known[name](comm)]
    if comm.rank == 0:
        print_table(
            f"validation on {counted(comm.size, 'rank')}",
            ("case", "quantity", "value", "reference", "error", "tolerance", "", "kind", "source"),
            [
                (
                    row["case"],
                    row["quantity"],
                    f"{row['value']:.7g}",
                    f"{row['reference']:.7g}",
                    f"{row['error']:.1e}",
                    f"{row['tolerance']:.0e}",
                    "passed" if row["passed"] else "FAILED",
                    row["kind"],
                    row["source"],
                )
                for row in rows
            ],
        )
        write_json(args, rows)
    return 0 if all(row["passed"] for row in rows) else 1
