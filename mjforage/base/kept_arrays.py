"""Arrays that take long to compute, kept beside the compiled kernels for other processes."""

import hashlib
from collections.abc import Callable, Iterable
from contextlib import suppress
from inspect import getsource
from types import ModuleType

import numba
import numpy as np
from numpy.typing import NDArray

from mjforage.base.atomic_files import atomic_write
from mjforage.base.errors import UserError
from mjforage.base.kernel_cache import delete_unused, kernel_folder, note_use

FloatArray = NDArray[np.float64]


def kept_array(
    shape: tuple[int, ...],
    compute: Callable[[], FloatArray],
    inputs: Iterable[object],
    modules: Iterable[ModuleType],
) -> FloatArray:
    """The array that `compute` gives, or gave to another process.

    Another source of a module, NumPy or numba is another array. A file that is damaged, or cannot
    be written, only costs the time; one that nobody has read for long is deleted.

    Parameters
    ----------
    shape : of the array
    inputs : all that it is computed from; arrays, or what has a text
    modules : that compute it
    """
    folder = kernel_folder()
    if folder is None:
        return compute()
    digest = hashlib.sha256(f"{np.__version__} {numba.__version__} {shape}".encode())
    for one in inputs:
        digest.update(one.tobytes() if isinstance(one, np.ndarray) else repr(one).encode())
    try:
        for module in modules:
            digest.update(getsource(module).encode())
    except OSError:  # without its source
        return compute()
    path = folder / "arrays" / f"{digest.hexdigest()}.npy"
    with suppress(OSError, ValueError, EOFError):
        found = np.load(path, allow_pickle=False)
        if found.shape == shape and found.dtype == np.float64 and np.isfinite(found).all():
            note_use(path)
            return np.asarray(found)
    found = compute()
    with suppress(OSError, UserError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as beside, beside.open("wb") as file:
            np.save(file, found, allow_pickle=False)
        delete_unused(path.parent, "*.npy")
    return found
