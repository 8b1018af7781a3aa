"""Callbacks of objects that own who calls them: a PETSc solver that kept its owner alive would never be freed.

Python's collector does not see through PETSc: such a circle stays for the life of the process, with all its matrices.
"""

from collections.abc import Callable
from typing import ParamSpec, TypeVar
from weakref import ref

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def weak_call(method: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """A function that calls a bound method and does not keep its object alive.

    Raises:
        ReferenceError: on a call, when the object is gone.
    """
    owner, function = ref(method.__self__), method.__func__  # type: ignore[attr-defined]

    def call(*arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        found = owner()
        if found is None:
            raise ReferenceError(f"the owner of a callback is gone: {function.__qualname__}")
        result: Result = function(found, *arguments, **named)
        return result

    return call
