"""What takes too long for every day."""

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def each_week(**daily: Any) -> Callable[[Function], Function]:
    """Marks a long function: `make weekly` runs it as it is, `make test` with other values of its module.

    Args:
        daily: by the names of the module's values; none: `make test` leaves the function out.
    """

    def mark(function: Function) -> Function:
        vars(function)["daily"] = daily
        return function

    return mark


def daily_values(function: Callable[..., Any]) -> dict[str, Any] | None:
    """The values of its module with which `make test` runs a function; {}: it does not; None: its own."""
    return vars(function).get("daily")
