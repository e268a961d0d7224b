"""Views of arrays that nobody can write."""

from typing import Any, TypeVar, cast

import numpy as np

A = TypeVar("A")


def view_of(array: A) -> A:
    """A view of an array that cannot be written.

    It is of a read-only buffer, so numpy refuses `setflags(write=True)` as well.
    """
    content: Any = array
    return cast(A, np.asarray(memoryview(content).toreadonly()))
