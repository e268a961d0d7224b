"""The one place of this package where numba is configured."""

from collections.abc import Callable
from typing import TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile `function` in nopython mode, cached on disk.

    No fast-math: sums keep their order, so a result never depends on the batch it is in.
    """
    return cast(F, numba.njit(cache=True, fastmath=False, nogil=True)(function))
