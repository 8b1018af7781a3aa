"""Temperatures on scales in formulas, such as ``20 degC``: what they are in K, and what may be done with them.

A scale's zero may enter a temperature once: ``20 degC + 5 K`` is a temperature and ``30 degC - 20 degC`` a difference,
but ``20 degC + 5 degC`` holds the zero twice, and ``2*20 degC`` too. So each term counts the zeros that it holds.
"""

import ast
from collections.abc import Collection
from typing import NamedTuple

from restshape.scene.units import SCALED, UnitError, on_scale

WHOLE = frozenset((0, 1))
"""Zeros that a temperature in K, or any other number, may hold: as one from absolute zero, or as a difference."""
DO = 'write what is added as a difference in K, as in "20 degC + 10 K" or "20 degC + (30 degC - 20 degC)*x"'


class _Term(NamedTuple):
    """A part of a formula.

    Args:
        zeros: counts of zeros that it may hold; None: any.
        written: it holds a temperature that is written on a scale.
    """

    zeros: frozenset[int] | None
    written: bool


FREE = _Term(WHOLE, False)


def in_kelvins(tree: ast.expr) -> ast.expr:
    """The tree with a number in K for each temperature on a scale, which a minus sign before it belongs to.

    Args:
        tree: of a formula whose text `units.in_si` gave; changed in place.

    Raises:
        UnitError: a temperature below absolute zero.
    """
    return _Kelvins().visit(tree)


class _Kelvins(ast.NodeTransformer):
    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        """A negative temperature on a scale is no negative temperature in K."""
        found = _scaled(node)
        return self.generic_visit(node) if found is None else _number(found, node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """A temperature on a scale is one in K."""
        found = _scaled(node)
        return self.generic_visit(node) if found is None else _number(found, node)


def _number(value: tuple[float, str], node: ast.expr) -> ast.Constant:
    return ast.copy_location(ast.Constant(on_scale(*value)), node)


def _scaled(node: ast.expr) -> tuple[float, str] | None:
    """A temperature and its scale, if the node is one that `units.in_si` has found."""
    match node:
        case ast.UnaryOp(op=ast.USub(), operand=ast.BinOp() as operand):
            found = _scaled(operand)
            return found and (-found[0], found[1])
        case ast.BinOp(left=ast.Constant(value=float() as number), op=ast.MatMult(), right=ast.Name(id=scale)):
            return number, SCALED[scale]
    return None


def check_temperatures(tree: ast.expr, named: Collection[str] = ()) -> None:
    """Refuses sums and products of temperatures on scales that are neither a temperature nor a difference.

    Args:
        tree: of a formula, before `in_kelvins`.
        named: parameters that are written on a scale.

    Raises:
        UnitError: the first of them, to be said behind the formula.
    """
    _check_sum(_term(tree, named))


def counts_from_zero(tree: ast.expr, named: Collection[str]) -> bool:
    """Whether a formula gives a temperature on a scale, as ``warm + 10 K`` does; arguments as of `check_temperatures`.

    Raises:
        UnitError: it multiplies one.
    """
    zeros = _term(tree, named).zeros
    return zeros is not None and 0 not in zeros and 1 in zeros


def _term(node: ast.expr, named: Collection[str]) -> _Term:
    """How many zeros a part of a formula may hold."""
    if _scaled(node):
        return _Term(frozenset((1,)), True)
    match node:
        case ast.Name(id=name) if name in named:
            return _Term(frozenset((1,)), False)
        case ast.UnaryOp(op=op, operand=operand):
            return _sum(_Term(frozenset((0,)), False), _term(operand, named), -1 if isinstance(op, ast.USub) else 1)
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
            return _sum(_term(left, named), _term(right, named), -1 if isinstance(op, ast.Sub) else 1)
        case ast.BinOp(left=left, right=right):
            return _product([_term(left, named), _term(right, named)])
        case ast.Call(func=ast.Name(id="abs" | "min" | "max"), args=arguments):
            terms = [_term(argument, named) for argument in arguments]
            for term in terms:
                _check_sum(term)
            return _Term(WHOLE.intersection(*(term.zeros or WHOLE for term in terms)) or None, terms[0].written)
        case ast.Call(args=arguments):
            return _product([_term(argument, named) for argument in arguments])
    return FREE


def _sum(one: _Term, other: _Term, sign: int) -> _Term:
    written = one.written or other.written
    if one.zeros is None or other.zeros is None:
        return _Term(None, written)
    return _Term(frozenset(p + sign * q for p in one.zeros for q in other.zeros), written)


def _product(terms: list[_Term]) -> _Term:
    """What a product, a power or a function makes of its terms: 0 degC times 2 depends on the scale, 273.15 K does not.

    Raises:
        UnitError: one of them is a temperature on a scale.
    """
    if any(term.written and term.zeros is not None and 0 not in term.zeros for term in terms):
        raise UnitError("multiplies a temperature on a scale, which begins at another zero than K", DO)
    return FREE if all(term.zeros is not None and 0 in term.zeros for term in terms) else _Term(None, False)


def _check_sum(term: _Term) -> None:
    """Refuses a sum that is neither a temperature nor a difference of two."""
    if term.zeros is not None and not WHOLE & term.zeros:
        raise UnitError("adds temperatures that each count from a zero of their own", DO)
