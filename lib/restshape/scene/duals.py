"""Dual numbers for formulas: values with their rates of change in one direction, carried through arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from typing import Union

import numpy as np

from restshape.arrays import Reals

Operand = Union["Dual", Reals, float]


class Dual:
    """An array of values with their rates; numbers and arrays mix with it as constants.

    One number compares with others by its value.

    Args:
        value: (...,) values.
        rate: (...,) their derivative along the direction.

    Source: A. Griewank, A. Walther, Evaluating Derivatives, 2nd edition, SIAM, 2008.
    """

    __slots__ = ("rate", "value")
    # Else numpy's scalars would make object arrays of it.
    __array_ufunc__ = None

    def __init__(self, value: Reals, rate: Reals | float = 0.0) -> None:
        self.value, self.rate = value, rate

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.rate)

    def __pos__(self) -> Dual:
        return self

    def __add__(self, other: Operand) -> Dual:
        other = dual(other)
        return Dual(self.value + other.value, self.rate + other.rate)

    def __sub__(self, other: Operand) -> Dual:
        other = dual(other)
        return Dual(self.value - other.value, self.rate - other.rate)

    def __mul__(self, other: Operand) -> Dual:
        other = dual(other)
        return Dual(self.value * other.value, self.rate * other.value + self.value * other.rate)

    def __truediv__(self, other: Operand) -> Dual:
        other = dual(other)
        ratio = self.value / other.value
        return Dual(ratio, (self.rate - ratio * other.rate) / other.value)

    def __pow__(self, other: Operand) -> Dual:
        other = dual(other)
        power = self.value**other.value
        rate = other.value * self.value ** (other.value - 1.0) * self.rate
        if np.any(other.rate):
            # The logarithm has no number at bases below 0, where only constant exponents make sense.
            rate = rate + power * np.log(self.value) * other.rate
        return Dual(power, rate)

    def __lt__(self, other: Operand) -> bool:
        return bool(self.value < dual(other).value)

    def __gt__(self, other: Operand) -> bool:
        return bool(self.value > dual(other).value)

    def __le__(self, other: Operand) -> bool:
        return bool(self.value <= dual(other).value)

    __radd__ = __add__
    __rmul__ = __mul__

    def __rsub__(self, other: Operand) -> Dual:
        return dual(other) - self

    def __rtruediv__(self, other: Operand) -> Dual:
        return dual(other) / self

    def __rpow__(self, other: Operand) -> Dual:
        return dual(other) ** self


def dual(number: Operand) -> Dual:
    """The number as it is if dual, else as a constant."""
    return number if isinstance(number, Dual) else Dual(np.asarray(number, dtype=float))


def _chain(function: Callable[[Reals], Reals], slope: Callable[[Reals], Reals]) -> Callable[[Operand], Dual]:
    def apply(a: Operand) -> Dual:
        a = dual(a)
        return Dual(function(a.value), slope(a.value) * a.rate)

    return apply


def _atan2(y: Operand, x: Operand) -> Dual:
    y, x = dual(y), dual(x)
    return Dual(np.arctan2(y.value, x.value), (x.value * y.rate - y.value * x.rate) / (x.value**2 + y.value**2))


def _choose(first: Callable[[Reals, Reals], Reals]) -> Callable[[Operand, Operand], Dual]:
    def apply(a: Operand, b: Operand) -> Dual:
        a, b = dual(a), dual(b)
        chosen = first(a.value, b.value)
        return Dual(np.where(chosen, a.value, b.value), np.where(chosen, a.rate, b.rate))

    return apply


FUNCTIONS: dict[str, Callable[..., Dual]] = {
    "sqrt": _chain(np.sqrt, lambda v: 0.5 / np.sqrt(v)),
    "sin": _chain(np.sin, np.cos),
    "cos": _chain(np.cos, lambda v: -np.sin(v)),
    "tan": _chain(np.tan, lambda v: 1.0 + np.tan(v) ** 2),
    "atan": _chain(np.arctan, lambda v: 1.0 / (1.0 + v**2)),
    "atan2": _atan2,
    "exp": _chain(np.exp, np.exp),
    "log": _chain(np.log, lambda v: 1.0 / v),
    # At a kink the rate is that of one side.
    "abs": _chain(np.abs, np.sign),
    "min": _choose(np.less_equal),
    "max": _choose(np.greater_equal),
}
