"""What a unit of counted work costs on a machine: decisions inside a replay come from this, never from a clock."""

import json
import os
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from restshape.bounds import CALIBRATION_BYTES
from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole

FORMAT = "restshape-calibration"
NOMINAL = Path(__file__).with_name("nominal.json")


@dataclass(frozen=True)
class Calibration:
    """Seconds a unit of counted work.

    Args:
        machine: what it was measured on, for people.
        symbolic_nonzero: symbolic Cholesky with its ordering, a nonzero of the factor.
        numeric_nonzero: numeric Cholesky, the part that grows with the nonzeros of the factor.
        numeric_work: numeric Cholesky, the part that grows with their power 3/2: the flops of a dense factor, of nested
            dissection in 3D, and but for a logarithm in 2D.
        solve_nonzero: forward and backward substitution, a nonzero passed (each is passed twice).
        ilu_numeric_nonzero: numeric incomplete LU, a nonzero of the factor.
        ilu_solve_nonzero: its substitution, a nonzero passed (each is passed once).
        matvec_nonzero: matrix times vector, a nonzero.
        vector_unknown: the vector updates and products of one iteration of conjugate gradients, an unknown.
        iteration: what an iteration costs besides.
        element: residual, tangent and insertion of a first-order triangle.
        gamg_setup_nonzero: algebraic multigrid from nothing, a nonzero of the matrices of all its grids.
        gamg_refresh_nonzero: the same with the interpolation kept.
        gamg_solve_nonzero: one cycle, a nonzero of the matrices of all its grids.
    """

    machine: str
    symbolic_nonzero: float
    numeric_nonzero: float
    numeric_work: float
    solve_nonzero: float
    ilu_numeric_nonzero: float
    ilu_solve_nonzero: float
    matvec_nonzero: float
    vector_unknown: float
    iteration: float
    element: float
    gamg_setup_nonzero: float
    gamg_refresh_nonzero: float
    gamg_solve_nonzero: float

    def pass_seconds(self, unknowns: int, nonzeros: float) -> float:
        """Seconds of one pass over the matrix and the vectors: an iteration without its preconditioner.

        Args:
            unknowns: rows of the matrix.
            nonzeros: of the matrix.
        """
        return self.matvec_nonzero * nonzeros + self.vector_unknown * unknowns + self.iteration

    def iteration_seconds(self, unknowns: int, nonzeros: float, filled: float) -> float:
        """Seconds of an iteration of conjugate gradients with a Cholesky factor.

        Args:
            unknowns: rows of the matrix.
            nonzeros: of the matrix.
            filled: nonzeros of the factor's triangle, `Mat.getInfo()["nz_used"]`.
        """
        return self.solve_nonzero * 2.0 * filled + self.pass_seconds(unknowns, nonzeros)

    def refresh_seconds(self, unknowns: int, nonzeros: float, filled: float) -> float:
        """Seconds of a new numeric factor on a pattern that has one already; arguments as in `iteration_seconds`."""
        growing = self.numeric_nonzero * filled + self.numeric_work * filled**1.5
        return growing + self.pass_seconds(unknowns, nonzeros)

    def factor_seconds(self, unknowns: int, nonzeros: float, filled: float) -> float:
        """Seconds of a factor on a new pattern; arguments as in `iteration_seconds`."""
        return self.symbolic_nonzero * filled + self.refresh_seconds(unknowns, nonzeros, filled)

    def as_dict(self) -> dict[str, object]:
        """The content of a calibration file, as a recording keeps it too."""
        seconds = asdict(self)
        return {"format": FORMAT, "version": 1, "machine": seconds.pop("machine"), "seconds": seconds}

    def save(self, path: Path) -> None:
        """Writes a calibration file; makes its folder.

        Raises:
            UserError: it cannot be written.
        """
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, json.dumps(self.as_dict(), indent=1) + "\n")
        except OSError as error:
            raise UserError(f"{error.strerror}: calibration not written", str(path), "name another file") from error

    @classmethod
    def load(cls, path: Path | None = None) -> "Calibration":
        """The calibration of a file, or the nominal one that ships, so that fresh clones decide alike.

        Raises:
            UserError: no such file, or not a calibration.
        """
        place = NOMINAL if path is None else path
        make = "restshape info --calibrate --out FILE writes one"
        try:
            with place.open(encoding="utf-8") as file:
                content = json.loads(file.read(CALIBRATION_BYTES))
        except OSError as error:
            raise UserError(error.strerror or str(error), str(place), make) from error
        except (ValueError, RecursionError) as error:
            raise UserError(f"not JSON: {error}", str(place), make) from error
        if not isinstance(content, dict) or content.get("format") != FORMAT or content.get("version") != 1:
            raise UserError(f"not a {FORMAT} file of version 1", str(place), make)
        return cls(str(content.get("machine", "")), **checked_seconds(content.get("seconds"), place))


def checked_seconds(seconds: object, place: Path) -> dict[str, float]:
    """The seconds of every unit, each a number that is not negative.

    Raises:
        UserError: a unit is missing, unknown or no such number.
    """
    units = [field.name for field in fields(Calibration) if field.name != "machine"]
    given = seconds if isinstance(seconds, dict) else {}
    for unit in (*units, *given):
        value = given.get(unit)
        good = isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value < float("inf")
        if unit not in units or not good:
            what = "no such unit" if unit not in units else f"needs a number of seconds, not {value!r}"
            raise UserError(
                what, f"{place}: seconds.{unit}", "restshape info --calibrate --out FILE writes a whole one"
            )
    return {unit: float(given[unit]) for unit in units}


def own_path() -> Path:
    """Where this machine's calibration is kept when no other file is named."""
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "restshape" / "calibration.json"
