"""Formulas in a scene: read from text, evaluated on arrays, with nothing but arithmetic in them."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from difflib import get_close_matches
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from restshape.arrays import Reals
from restshape.bounds import FORMULA_CHARACTERS
from restshape.errors import ValueProblem, quoted
from restshape.scene import duals
from restshape.scene.duals import Dual
from restshape.scene.temperature_scales import check_temperatures, in_kelvins
from restshape.scene.units import UNITS, UnitError, in_si

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

Number = TypeVar("Number", Reals, Dual)

FUNCTIONS: dict[str, tuple[Callable[..., Reals], int]] = {
    "sqrt": (np.sqrt, 1),
    "sin": (np.sin, 1),
    "cos": (np.cos, 1),
    "tan": (np.tan, 1),
    "atan": (np.arctan, 1),
    "atan2": (np.arctan2, 2),
    "exp": (np.exp, 1),
    "log": (np.log, 1),
    "abs": (np.abs, 1),
    "min": (np.minimum, 2),
    "max": (np.maximum, 2),
}
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**", ast.USub: "-", ast.UAdd: "+"}
COORDINATES = ("x", "y")
PLACES_AND_TIME = (*COORDINATES, "t")
CONSTANTS = {"pi": np.pi}
MAX_DEPTH = 100
DASHES = "\u2212\u2013\u2014"
"""Minus sign and dashes of typesetting."""
DECIMAL_COMMA = re.compile(r"\d,\d")
CALL = re.compile(r"[A-Za-z_]\w*\s*\(.*", re.DOTALL)
"""What may be a call, with all after it: commas are between arguments there."""
NO_BUILTINS: dict[str, dict[str, object]] = {"__builtins__": {}}
"""What formulas know besides their names: nothing."""
STEPS = (1.3e-6, 1.3e-9, 1.3e-12)
"""Relative changes of numbers in a formula by which the rounding of its value is judged."""
ROUNDINGS = 2.0 * float(np.finfo(float).eps)
"""Relative error of each number in a formula, and of the operation that takes it."""


class ExpressionError(ValueProblem):
    """A formula that cannot be read, or that names something unknown."""


class NoFormula(ExpressionError):
    """A text that does not even read as a formula."""


class Expression:
    """A formula of the material coordinates ``x`` and ``y``, of ``pi`` and of the scene's parameters.

    Args:
        text: for example ``"-P*(L - x)*y/I"``; ``^`` is a power, as ``**`` is, and numbers
            may have a unit, as in ``3 mm*(1 - x/2)``.
        wanted: name of the dimension that its value must have; None: of any, or not known.
        coordinates: names that are no parameters; a value that is none of a place is given among the parameters.

    Attributes:
        has_units: a number in it has a unit.
        is_sum: what stands behind it belongs to its last term alone.

    Raises:
        ExpressionError: not a formula of + - * / ** ^, numbers, names and the known functions; `NoFormula` where it
            does not read as one at all.
    """

    __slots__ = ("_code", "_numbers", "coordinates", "has_units", "is_sum", "names", "text", "wanted")

    def __init__(self, text: str, wanted: str | None = None, coordinates: Sequence[str] = COORDINATES) -> None:
        self.text, self.wanted, self.coordinates = text, wanted, tuple(coordinates)
        if len(text) > FORMULA_CHARACTERS:
            what = f"the formula is {len(text)} characters long, and {FORMULA_CHARACTERS} are allowed"
            raise ExpressionError(what, "write a shorter one")
        body = parsed(text)
        names: set[str] = set()
        _examine(body, text, names, 0)
        try:
            check_temperatures(body)
        except UnitError as error:
            raise ExpressionError(f"{quoted(text)} {error.what}", error.do) from error
        self.has_units = in_si(text) != text
        tree = ast.Expression(in_kelvins(body))
        numbers = _Numbers()
        tree = numbers.visit(tree)
        self._numbers = numbers.values
        self.names = frozenset(names)
        self.is_sum = isinstance(body, ast.BinOp) and isinstance(body.op, ast.Add | ast.Sub)
        self._code = compile(tree, "<formula>", "eval")

    def __repr__(self) -> str:
        return f"Expression({self.text!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Expression) and other.text == self.text

    def __hash__(self) -> int:
        return hash(self.text)

    @property
    def names_places(self) -> bool:
        """Whether it depends on x or y."""
        return not self.names.isdisjoint(COORDINATES)

    @property
    def parameters(self) -> list[str]:
        """The parameters that it names, in alphabetical order."""
        return sorted(self.names.difference(self.coordinates, CONSTANTS))

    def missing(self, parameters: Collection[str], coordinates: Sequence[str] | None = None) -> tuple[str, str] | None:
        """A name in the formula that is neither a coordinate nor a parameter, and what may have been meant; or None."""
        coordinates = self.coordinates if coordinates is None else coordinates
        for name in sorted(self.names):
            if name in coordinates or name in CONSTANTS or name in parameters:
                continue
            near = get_close_matches(name, [*coordinates, *CONSTANTS, *parameters], n=1)
            if self.has_units and name in UNITS:
                return name, 'give a number with a compound unit a name in [parameters], such as a = "1000 kg/m^3"'
            return name, f"did you mean {near[0]!r}?" if near else ""
        return None

    def unknown(self, parameters: Collection[str], coordinates: Sequence[str] | None = None) -> ExpressionError | None:
        """The error of what the formula names although it is neither a coordinate nor a parameter; or None."""
        coordinates = self.coordinates if coordinates is None else coordinates
        missing = self.missing(parameters, coordinates)
        if missing is None:
            return None
        name, do = missing
        known = ", ".join([*coordinates, *CONSTANTS, *parameters])
        what = f"the formula {quoted(self.text)} names {name!r}, which is not in [parameters]"
        return ExpressionError(what, do or f"known names: {known}")

    def evaluate(self, x: ArrayLike, y: ArrayLike, parameters: Mapping[str, float]) -> Reals:
        """The formula at points, in the shape of x and y broadcast; not finite where the formula is not.

        Args:
            x: (...,) material coordinate [m].
            y: (...,) material coordinate [m].
            parameters: value of each named parameter.

        Raises:
            ExpressionError: an unknown name.
        """
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        known = {name: function for name, (function, _) in FUNCTIONS.items()}
        result = self._run(known, x, y, parameters)
        return np.array(np.broadcast_to(result, x.shape), dtype=np.float64)

    def rate(self, x: Dual, y: Dual, parameters: Mapping[str, float]) -> Reals:
        """The derivative of the formula along the direction in which the coordinates change.

        Args:
            x, y: (...,) coordinates [m] and their rates.
            parameters: value of each named parameter.

        Raises:
            ExpressionError: an unknown name.
        """
        result = duals.dual(self._run(duals.FUNCTIONS, x, y, parameters))
        return np.array(np.broadcast_to(result.rate, np.shape(x.value)), dtype=np.float64)

    def parameter_rate(self, x: ArrayLike, y: ArrayLike, parameters: Mapping[str, float], name: str) -> Reals:
        """The derivative of the formula by a parameter, in the shape of x and y broadcast.

        Args:
            x, y: (...,) coordinates [m].
            parameters: value of each named parameter.
            name: of the parameter.

        Raises:
            ExpressionError: an unknown name.
        """
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        result = duals.dual(self._run(duals.FUNCTIONS, duals.dual(x), duals.dual(y), parameters, name))
        return np.array(np.broadcast_to(result.rate, x.shape), dtype=np.float64)

    def rounding(self, parameters: Mapping[str, float]) -> float:
        """What the value at x = y = 0 may have by rounding alone: below, a difference or a cosine may be 0.

        Each number, at each place where it stands, is changed by itself. A value that changes less, relative to the
        change, where that is larger is at a pole or a jump: the least of the rates counts.

        Args:
            parameters: value of each named parameter.

        Raises:
            ExpressionError: an unknown name.
        """
        value = float(self.evaluate(0.0, 0.0, parameters))
        inputs = _Inputs({**dict.fromkeys(self.coordinates, 0.0), **CONSTANTS, **parameters})
        tree = inputs.visit(ast.Expression(in_kelvins(parsed(self.text))))
        code, values = compile(tree, "<formula>", "eval"), inputs.values
        known = {name: function for name, (function, _) in FUNCTIONS.items()}
        bound: float = 0.0
        for name, number in values.items():
            with np.errstate(all="ignore"):
                changed = [eval(code, NO_BUILTINS, {**known, **values, name: number * (1.0 + step)}) for step in STEPS]
                rates = np.abs(np.array(changed) - value) / STEPS
            bound += float(ROUNDINGS * np.nan_to_num(rates, posinf=0.0).min())
        return bound

    def _run(
        self,
        functions: Mapping[str, Callable[..., Number]],
        x: Number,
        y: Number,
        parameters: Mapping[str, float],
        changing: str = "",
    ) -> Number | float:
        """The formula in whatever arithmetic the coordinates and functions bring; one parameter may change by 1."""
        unknown = self.unknown(parameters)
        if unknown:
            raise unknown
        named = ((name, parameters.get(name, CONSTANTS.get(name))) for name in self.names.difference(COORDINATES))
        values: dict[str, np.float64 | Dual] = {name: np.float64(value) for name, value in named}
        if changing in values:
            values[changing] = Dual(np.asarray(parameters[changing], float), 1.0)
        with np.errstate(all="ignore"):
            return eval(self._code, NO_BUILTINS, {**functions, **self._numbers, **values, "x": x, "y": y})


Value = float | Expression


def parsed(text: str, marked: bool = False) -> ast.expr:
    """The tree of a formula, its numbers in SI units; `temperature_scales.in_kelvins` takes the marks out of it.

    Args:
        text: the formula.
        marked: numbers that have units are marked by them, as of `units.in_si`.

    Raises:
        ExpressionError: it is none.
        UnitError: a unit in it could mean two things.
    """
    # The sign by which `in_si` marks temperatures.
    if "@" in text:
        raise _no_formula(text)
    plain = in_si(text, marked)
    try:
        return ast.parse(plain.strip().replace("^", "**"), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise NoFormula(f"{quoted(text)} is not a formula", _as_typed(text)) from error


def _no_formula(text: str) -> NoFormula:
    do = f"use + - * / ^, numbers, x, y, pi, parameters and {', '.join(FUNCTIONS)}"
    return NoFormula(f"{quoted(text)} holds something that formulas may not hold", _as_typed(text) or do)


def _as_typed(text: str) -> str:
    """What to write in place of signs that word processors and other languages put into numbers; empty without any."""
    if any(dash in text for dash in DASHES):
        return "write the minus sign of the keyboard, -"
    return "write a decimal point, as in 2.5" if DECIMAL_COMMA.search(CALL.sub("", text)) else ""


def _examine(node: ast.AST, text: str, names: set[str], depth: int) -> None:
    """Refuses all that is not arithmetic, and collects the names."""
    if depth > MAX_DEPTH:
        raise ExpressionError(f"{quoted(text)} is nested too deeply")
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            inner: list[ast.AST] = []
        case ast.Name(id=name):
            if name in FUNCTIONS:
                raise ExpressionError(f"{name!r} in {quoted(text)} is a function", f"write {name}(...)")
            names.add(name)
            inner = []
        case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
            inner = [operand]
        case ast.BinOp(left=left, op=ast.MatMult()):
            inner = [left]
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            inner = [left, right]
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            inner = list(arguments)
            _check_call(name, len(inner), text)
        case ast.Call():
            raise ExpressionError(f"{quoted(text)} calls something that is not one of {', '.join(FUNCTIONS)}")
        case _:
            raise _no_formula(text)
    for part in inner:
        _examine(part, text, names, depth + 1)


def _check_call(name: str, count: int, text: str) -> None:
    """Refuses a function that is not known, or the wrong count of arguments."""
    if name not in FUNCTIONS:
        near = get_close_matches(name, FUNCTIONS, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"known functions: {', '.join(FUNCTIONS)}"
        raise ExpressionError(f"{quoted(text)} calls {name!r}, which is not a known function", hint)
    wanted = FUNCTIONS[name][1]
    if count != wanted:
        raise ExpressionError(f"{name} in {quoted(text)} takes {wanted} argument{'s' * (wanted > 1)}, not {count}")


class _Numbers(ast.NodeTransformer):
    """Moves the numbers of a formula out of it, as numpy scalars.

    Python's own would overflow, divide by zero or turn complex with an error; whole ones could grow without bound.
    """

    def __init__(self) -> None:
        self.values: dict[str, np.float64] = {}

    def visit_Constant(self, node: ast.Constant) -> ast.Name:
        """A name that no formula can hold, in place of the number."""
        assert isinstance(node.value, int | float), "formulas hold no other constants"
        try:
            return self._moved(node, np.float64(node.value))
        except OverflowError as error:
            raise ExpressionError("a number in the formula is too large") from error

    def _moved(self, node: ast.expr, value: np.float64) -> ast.Name:
        name = f"#{len(self.values)}"
        self.values[name] = value
        return ast.copy_location(ast.Name(id=name, ctx=ast.Load()), node)


class _Inputs(_Numbers):
    """Moves the values of names out of a formula, too, one for each place where a name stands."""

    def __init__(self, known: Mapping[str, float]) -> None:
        super().__init__()
        self.known = known

    def visit_Call(self, node: ast.Call) -> ast.Call:
        """A function has no value of its own."""
        node.args = [self.visit(one) for one in node.args]
        return node

    def visit_Name(self, node: ast.Name) -> ast.Name:
        """A name of this place alone."""
        return self._moved(node, np.float64(self.known[node.id]))
