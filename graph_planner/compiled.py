"""The one place where numba is configured: every hot function of ours is an `@kernel`.

Kernels take related arrays as one named tuple, and take what they need out of it
before their loops: reading a field counts references, which costs more than the arithmetic.
"""

from collections.abc import Callable
from typing import TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile `function` in nopython mode, cached on disk, without fast-math.

    Fast-math is left out so that results are bitwise the same whatever the batch size.
    """
    return cast(F, numba.njit(cache=True, fastmath=False, nogil=True)(function))


def inlined(function: F) -> F:
    """Compile a helper that is pasted into its callers, for innermost loops passing arrays."""
    return cast(F, numba.njit(cache=True, fastmath=False, nogil=True, inline="always")(function))
