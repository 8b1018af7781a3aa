"""The named numbers of a scene: each is written as one, or as a formula of others."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter

from restshape.errors import UserError, ValueProblem, quoted
from restshape.scene.dimensions import is_on_scale, plain_powers, powers_of_formula, powers_of_number
from restshape.scene.expressions import Expression, ExpressionError, parsed
from restshape.scene.plain_values import Table, table_in
from restshape.scene.source import Source
from restshape.scene.temperature_scales import counts_from_zero
from restshape.scene.units import (
    EXAMPLES,
    Powers,
    UnitError,
    article,
    quantity,
    reads_as_quantity,
    refuse_impossible,
    spelled,
)


@dataclass(frozen=True)
class Parameters:
    """The parameters of a scene, of which formulas are made.

    Args:
        values: in SI units, by name.
        written: as they stand in the file.
        powers: of those whose dimension is known.
        on_scale: those that are temperatures on a scale.
    """

    values: dict[str, float] = field(default_factory=dict)
    written: Mapping[str, object] = field(default_factory=dict)
    powers: dict[str, Powers] = field(default_factory=dict)
    on_scale: set[str] = field(default_factory=set)

    def check_units(self, formula: Expression) -> Powers | None:
        """The powers of a formula, as far as they are known.

        Raises:
            UnitError: it adds what cannot be added, or gives another dimension than is wanted of it.
        """
        try:
            places = formula.names.intersection(formula.coordinates).difference(self.values)
            wanted = None if formula.wanted is None else plain_powers(formula.wanted)
            found = powers_of_formula(formula.text, self.powers, self.on_scale, places, wanted)
        except UnitError as error:
            do = error.do or "give parameters and numbers units that fit"
            raise UnitError(f"{formula.text!r} {error.what}", do) from error
        measured = formula.has_units or not formula.names.isdisjoint(self.powers)
        if found is None or formula.wanted is None or not measured or found == wanted:
            return found if measured else None
        units = ", ".join(
            f"{name} = {self.written[name]!r}" for name in sorted(formula.names.intersection(self.powers))
        )
        given = f" ({units})" if units else ""
        what = f"{formula.text!r} is {article(spelled(found))}{given}, but {article(formula.wanted)} is wanted"
        example = EXAMPLES[formula.wanted]
        do = f"give the parameter another unit, as in {example}"
        if not units:
            do = f"multiply by a parameter that makes it one, as [parameters] a = {example} does of a number"
        raise UnitError(what, do)

    def number(self, formula: Expression) -> float:
        """The value of a formula of parameters alone, in SI units.

        Raises:
            ExpressionError: it names what is no parameter.
            UnitError: its dimension is not what is wanted, or it gives no number that there can be.
        """
        if formula.names_places:
            raise ExpressionError(
                f"this is one number: the formula {quoted(formula.text)} cannot name x or y", "use [parameters] only"
            )
        if missing := formula.missing(self.values, ()):
            name, do = missing
            what = f"{quoted(formula.text)} is not a number with a unit, and as a formula it names {name!r}"
            example = EXAMPLES.get(formula.wanted or "", '"12 mm"')
            raise ExpressionError(f"{what}, which is not in [parameters]", do or f"write a number or {example}")
        self.check_units(formula)
        value = float(formula.evaluate(0.0, 0.0, self.values))
        if not math.isfinite(value):
            raise UnitError(f"the formula {formula.text!r} gives {value}", "change it, or the parameters")
        try:
            refuse_impossible(value, formula.wanted)
        except UnitError as error:
            raise UnitError(f"{formula.text!r}: {error.what}", error.do) from error
        return value


def read_parameters(raw: Table, source: Source) -> Parameters:
    """The parameters of the plain tables of a scene.

    Args:
        raw: of a scene; what cannot be read as a number or a formula is left to its validation.
        source: for messages.

    Raises:
        UserError: a formula cannot be read or has no value, names what is no parameter, or depends on itself.
    """
    written = table_in(raw, "parameters")
    texts = {name: one for name, one in written.items() if isinstance(one, str) and not reads_as_quantity(one)}
    found = Parameters(written=written, on_scale={name for name in written if is_on_scale(written[name])})
    for name, one in written.items():
        if name not in texts and isinstance(one, int | float | str):
            _take_number(found, name, one, source)
    formulas = {name: _formula(name, text, written, source) for name, text in texts.items()}
    for name in _in_order(formulas, source):
        try:
            powers = found.check_units(formulas[name])
            found.values[name] = found.number(formulas[name])
        except ValueProblem as error:
            raise source.error(("parameters", name), error.what, error.do) from error
        if powers is not None:
            found.powers[name] = powers
        if counts_from_zero(parsed(texts[name]), found.on_scale):
            found.on_scale.add(name)
    return found


def _take_number(found: Parameters, name: str, one: float | str, source: Source) -> None:
    """Takes up a parameter that is written as a number."""
    try:
        found.values[name] = quantity(one, None)
        powers = powers_of_number(one)
    except ValueProblem as error:
        raise source.error(("parameters", name), error.what, error.do) from error
    if powers is not None:
        found.powers[name] = powers


def _formula(name: str, text: str, known: Table, source: Source) -> Expression:
    """The formula of a parameter, all of whose names are parameters."""
    try:
        formula = Expression(text)
        if formula.names_places:
            raise ExpressionError(f"a parameter is one number: {text!r} cannot name x or y", "use other parameters")
        if unknown := formula.unknown(known, ()):
            raise unknown
    except ValueProblem as error:
        raise source.error(("parameters", name), error.what, error.do) from error
    return formula


def _in_order(formulas: Mapping[str, Expression], source: Source) -> list[str]:
    """The names of formulas, each behind those that it is made of.

    Raises:
        UserError: one is made of itself.
    """
    sorter = TopologicalSorter({name: formula.parameters for name, formula in formulas.items()})
    try:
        return [name for name in sorter.static_order() if name in formulas]
    except CycleError as error:
        raise _cycle(error.args[1][::-1], formulas, source) from error


def _cycle(chain: Sequence[str], formulas: Mapping[str, Expression], source: Source) -> UserError:
    """The error of parameters that are made of each other in a circle."""
    steps = ", ".join(f"{name} = {formulas[name].text!r}" for name in chain[:-1])
    what = f"the parameter {chain[0]!r} is made of itself: {' -> '.join(chain)} ({steps})"
    return source.error(("parameters", chain[0]), what, "give one of them a number")
