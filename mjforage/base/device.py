"""Kernels of ours on a GPU, from the source that numba compiles for a processor.

A kernel goes through the episodes of a batch. On a GPU each of many threads calls it with views of
one episode alone, so that the kernel itself need not know. What episodes share stays whole, and
memory that they use one after the other is there once for each.

Results differ from a processor's in their last bits: CUDA has functions such as `sin` of its own
and joins a product and a sum. Kernels for it allocate no arrays and set no array to another one.
"""

import importlib
import os
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mjforage.base.compiled import BoundKernel, kernel
from mjforage.base.errors import UserError
from mjforage.base.extras import require

THREADS = 32  # of a block: few, so that a small batch has blocks for all multiprocessors
FIRST = np.zeros(1, np.int64)  # index of the one episode that a thread has
Kind = Any  # "array", "number", or the class of a tuple and the kinds of its parts
Call = Callable[[Any], None]
"""A kernel bound to its arguments; it is given a stream of CUDA, 0 for its own."""
Bind = Callable[..., Call]
"""Binds a `Launch` to arrays of the host, or to what these are on a device."""
SIMULATED = os.environ.get("NUMBA_ENABLE_CUDASIM") == "1"  # in Python, see numba's documentation
_THREAD = """
def thread(episodes, arguments):
    e = cuda.grid(1)
    if e < episodes:
        kernel({})
"""


def require_gpu(what: str) -> None:
    """Refuse to go on without a GPU.

    Parameters
    ----------
    what : that needs it, for the message

    Raises
    ------
    UserError
        If there is none, or the libraries for it are missing.
    """
    require(what, "numba_cuda")
    if not _cuda().is_available():
        raise UserError(f"{what}: there is no GPU with a CUDA driver here; leave it out")


class OnDevice:
    """Arrays of the host and their copies on a device; the same array has the same copy."""

    def __init__(self, here: bool = False) -> None:
        """Begin without arrays.

        `here`: True if the device is this processor, on which arrays are their own copies.
        """
        self.here, self._memory_bytes = here, 0
        self._copies: dict[int, tuple[NDArray[Any], Any]] = {}
        self._bound: list[tuple[NDArray[Any], Any]] = []  # in the order in which kernels were given
        self._of_threads: list[Any] = []  # likewise
        self._before: OnDevice | None = None
        self._rows = FIRST

    def renewed(self, rows: NDArray[np.int64]) -> "OnDevice":
        """The same memory of the device for other arrays of the host, of which some rows are new.

        Kernels have to be bound again in the same order, to arrays of the same shapes; what is
        bound beyond that is copied whole.

        Parameters
        ----------
        rows : (row,) episodes whose rows are written into memory of the device; of arrays that all
            episodes share, all is written
        """
        new = OnDevice(self.here)
        new._before, new._rows = self, rows
        if self._before is not None:  # some of which may not be bound again yet
            self._bound += self._before._bound[len(self._bound) :]
            self._of_threads += self._before._of_threads[len(self._of_threads) :]
            self._before = None
        return new

    def bound(self, array: NDArray[Any], shared: bool) -> Any:
        """The copy of an array to which a kernel is bound, see `renewed`.

        `shared`: True if all episodes have it.
        """
        before = self._before._bound if self._before else []
        if len(self._bound) < len(before) and not self.here and id(array) not in self._copies:
            old, copy = before[len(self._bound)]
            _check_alike(array, old)
            self._copies[id(array)] = array, copy
            if not shared:
                _write_rows(array, copy, self._rows)
            elif not (old is array or np.array_equal(old, array)):
                _write(array, copy)
        self._bound.append((array, self.of(array)))
        return self._bound[-1][1]

    def of(self, array: NDArray[Any]) -> Any:
        """The copy of an array, made when it is first asked for."""
        if id(array) not in self._copies:
            self._copies[id(array)] = array, array if self.here else _copied(array)
        return self._copies[id(array)][1]

    def of_threads(self, array: NDArray[Any], threads: int) -> Any:
        """A copy for each thread, whatever it holds; one for all on this processor."""
        if self.here:
            return self.of(array)
        self._memory_bytes += threads * array.nbytes
        before = self._before._of_threads if self._before else []
        every = np.broadcast_to(array, (threads, *array.shape))
        number = len(self._of_threads)
        copy = before[number] if number < len(before) else _copied(every)
        _check_alike(every, copy)
        self._of_threads.append(copy)
        return copy

    def shared(self, copy: Any) -> NDArray[Any]:
        """An array of the host for which one of Warp, of plain numbers, stands on the device."""
        memory = copy.numpy() if self.here or SIMULATED else _cuda().as_cuda_array(copy)
        array = memory if self.here else np.zeros(memory.shape, memory.dtype)
        self._copies[id(array)] = array, memory
        return array

    @property
    def memory_bytes(self) -> int:
        """Memory of all copies, and of that of threads."""
        return self._memory_bytes + sum(array.nbytes for array, _ in self._copies.values())

    def tensor(self, array: NDArray[Any]) -> Any:
        """The copy of an array as a tensor of torch, in the same memory."""
        torch, copy = importlib.import_module("torch"), self.of(array)
        return torch.from_numpy(copy) if self.here or SIMULATED else torch.as_tensor(copy)

    @property
    def arrays(self) -> list[NDArray[Any]]:
        """All arrays of the host that have copies."""
        return [array for array, _ in self._copies.values()]

    def send(self, array: NDArray[Any]) -> None:
        """Write what an array of the host holds into its copy."""
        if not self.here:
            _write(array, self.of(array))

    def fetch(self, array: NDArray[Any]) -> NDArray[Any]:
        """Write what its copy holds into an array of the host, and return that."""
        if not self.here:
            copy = self.of(array)
            array[...] = copy if SIMULATED else copy.copy_to_host()
        return array


class Launch:
    """A kernel, one thread for each episode of a batch."""

    def __init__(
        self, kernel: Callable[..., object], *, shared: str = "", memory: str = ""
    ) -> None:
        """Say which arrays have no axis of episodes; all others have it as their first one.

        An argument `ids`, indices of episodes, is a mask of them on the device.

        Parameters
        ----------
        kernel : one of this package
        shared : names of arrays that all episodes share, by a blank: of an argument, of a field of
            a named tuple, or both with a point between them
        memory : names of arrays that one episode after the other uses; each thread has its own
        """
        self.kernel, self._shared, self._memory = kernel, shared.split(), memory.split()
        self._compiled: dict[object, Any] = {}

    def arguments(self, device: OnDevice, episodes: int, *given: object) -> tuple[Any, ...]:
        """The arguments with arrays of the device in place of those of the host."""
        return tuple(
            self._moved(device, episodes, name, value)
            for name, value in zip(names_of(self.kernel), given, strict=True)
        )

    def bound(self, device: OnDevice, episodes: int, *given: object) -> Call:
        """The kernel on these arguments."""
        names, arguments = names_of(self.kernel), self.arguments(device, episodes, *given)
        if not device.here:
            return lambda stream: self(episodes, *arguments, stream=stream)
        masked, bound = "ids" in names, BoundKernel(self.kernel)
        at = names.index("ids") if masked else 0

        def call(stream: Any) -> None:
            ids = (np.flatnonzero(cast(Any, arguments[at])),) if masked else arguments[at : at + 1]
            bound(*arguments[:at], *ids, *arguments[at + 1 :])

        return call

    def __call__(self, episodes: int, *arguments: object, stream: Any = 0) -> None:
        """Run the kernel on arguments of the device; it may still run when this returns."""
        kinds = tuple(map(kind_of, arguments))
        if kinds not in self._compiled:
            self._compiled[kinds] = _cuda().jit(self.thread(*kinds))
        blocks = -(-episodes // THREADS)
        self._compiled[kinds][blocks, THREADS, stream](episodes, arguments)

    def thread(self, *kinds: Kind) -> Callable[..., None]:
        """The function of a thread, of (number of episodes, arguments), to be compiled for CUDA."""
        known = {"kernel": self.kernel, "cuda": _cuda(), "FIRST": FIRST}
        parts = [
            self._view(name, f"arguments[{k}]", kind, known)
            for k, (name, kind) in enumerate(zip(names_of(self.kernel), kinds, strict=True))
        ]
        exec(_THREAD.format(", ".join(parts)), known)  # our own text
        return cast(Callable[..., None], known["thread"])

    def is_memory(self, name: str) -> bool:
        """True if each thread has an array of this name of its own."""
        return _is_in(name, self._memory)

    def _moved(self, device: OnDevice, episodes: int, name: str, value: Any) -> Any:
        if isinstance(value, tuple):
            inside = [f"{name}.{one}" for one in _fields(type(value), len(value))]
            parts = [
                self._moved(device, episodes, *each) for each in zip(inside, value, strict=True)
            ]
            return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
        if not isinstance(value, np.ndarray):
            return value
        if self.is_memory(name):
            return device.of_threads(value, episodes)
        return device.bound(value, _is_in(name, self._shared))

    def _view(self, name: str, text: str, kind: Kind, known: dict[str, Any]) -> str:
        """The text of an argument, or a part of one, as a thread gives it to the kernel."""
        if isinstance(kind, tuple):
            made, parts = kind[0], kind[1:]
            fields = _fields(made, len(parts))
            named = hasattr(made, "_fields")
            inside = [f"{text}.{one}" if named else f"{text}[{one}]" for one in fields]
            names = [f"{name}.{one}" for one in fields]
            views = [self._view(*each, known) for each in zip(names, inside, parts, strict=True)]
            known[made.__name__] = made
            return f"{made.__name__ if named else ''}({', '.join(views)},)"
        if kind == "number" or _is_in(name, self._shared):
            return text
        if name == "ids":
            return f"FIRST[: 1 if {text}[e] else 0]"
        return f"{text}[e]" if self.is_memory(name) else f"{text}[e : e + 1]"


@kernel
def _put_rows(values: NDArray[Any], place: NDArray[np.int64], into: NDArray[Any]) -> None:
    """Write values (row, ...) into episodes that have a place (episode,) of 0 or more in them."""
    for e in range(place.size):
        for k in range(into.shape[1] if place[e] >= 0 else 0):
            into[e, k] = values[place[e], k]


PUT_ROWS = Launch(_put_rows, shared="values")


def _cuda() -> Any:
    """The module of numba for CUDA, which takes a while to import."""
    return importlib.import_module("numba.cuda")


@cache
def names_of(kernel: Any) -> tuple[str, ...]:
    """Names of a kernel's arguments."""
    code = getattr(kernel, "py_func", kernel).__code__
    return tuple(code.co_varnames[: code.co_argcount])


def kind_of(value: Any) -> Kind:
    """The kind of a value, on which the text of a thread depends."""
    if isinstance(value, tuple):
        return (type(value), *map(kind_of, value))
    return "array" if hasattr(value, "shape") and value.shape != () else "number"


def _fields(kind: Any, parts: int) -> Sequence[str]:
    """Names of a tuple's parts, or their numbers."""
    names: Sequence[str] = getattr(kind, "_fields", tuple(map(str, range(parts))))
    return names


def _is_in(name: str, wanted: list[str]) -> bool:
    """True if a name, of an argument and fields within it, has one of these among its parts."""
    return any(f".{one}." in f".{name}." for one in wanted)


def _copied(array: NDArray[Any]) -> Any:
    whole = np.ascontiguousarray(array)
    return whole.copy() if SIMULATED else _cuda().to_device(whole)


def _check_alike(array: NDArray[Any], before: Any) -> None:
    """Raise `ValueError` if an array does not fit where another was."""
    if (array.shape, array.dtype) != (before.shape, before.dtype):
        raise ValueError(f"bound {array.dtype} {array.shape}, before {before.dtype} {before.shape}")


def _write_rows(array: NDArray[Any], copy: Any, rows: NDArray[np.int64]) -> None:
    """Write rows of an array of the host into its copy."""
    if not array.size or not rows.size:
        return
    place = np.full(len(array), -1)
    place[rows] = np.arange(rows.size)
    kind = np.int64 if array[:1].nbytes % 8 == 0 else np.uint8  # whatever it holds
    values = array[rows].reshape(rows.size, -1).view(kind)
    into = copy.reshape(len(array), -1).view(kind)
    PUT_ROWS(len(array), _copied(values), _copied(place), into)


def _write(array: NDArray[Any], copy: Any) -> None:
    if SIMULATED:
        copy[...] = array
    else:
        copy.copy_to_device(np.ascontiguousarray(array))
