"""Copies of an environment in memory, which go on as it would have gone on, to the bit.

For planners that look ahead (`copy.deepcopy`) and for workers in other processes (`pickle`, spawn).
Arrays that look at one piece of memory do so in a copy too, and what is read-only stays so: kernels
write where observations and encoders read, and are compiled for arrays of one kind.
"""

import io
import pickle
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

PROTOCOL = 5


class Copied:
    """Base of objects that `copy.deepcopy` and `pickle` copy whole, with no shared memory."""

    def __reduce_ex__(self, protocol: Any) -> tuple[Any, ...]:
        """Its content, of which memory is copied once."""
        content, buffers = _parts(self)
        return _again, (content, *map(bytearray, buffers))

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        """Another one, which shares read-only memory, such as that of the map."""
        content, buffers = _parts(self)
        return _again(content, *(b if b.raw().readonly else bytearray(b) for b in buffers))


def _parts(environment: Copied) -> tuple[bytes, list[pickle.PickleBuffer]]:
    """Its content, and the memory of its arrays, live."""
    content, buffers = io.BytesIO(), list[pickle.PickleBuffer]()
    _Pickler(content, environment, buffers).dump(environment)
    return content.getvalue(), buffers


def _again(content: bytes, *buffers: Any) -> Any:
    return pickle.loads(content, buffers=buffers)  # noqa: S301  made in memory by `Copied`


class _Memory:
    """Memory of an array that numpy would not make again as it is."""

    def __init__(self, root: NDArray[Any]) -> None:
        self.root = root  # kept, or another one could get its address

    def __reduce__(self) -> tuple[Any, ...]:
        content: Any = self.root.ravel("K").view(np.uint8)
        return _memory, (pickle.PickleBuffer(content),)


def _memory(content: Any) -> NDArray[np.uint8]:
    return np.frombuffer(content, np.uint8)


def _view(
    memory: NDArray[Any],
    offset: int,
    shape: tuple[int, ...],
    strides: tuple[int, ...],
    kind: np.dtype[Any],
    writeable: bool,
) -> NDArray[Any]:
    whole: Any = memory
    of: Any = whole if writeable else memoryview(whole).toreadonly()
    return np.ndarray(shape, kind, of, offset, strides)


def _looked_at(array: NDArray[Any]) -> object:
    """Owner of the memory of an array, read-only views included."""
    return array.base.obj if isinstance(array.base, memoryview) else array.base


def _proxy(content: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(content)


class _Pickler(pickle.Pickler):
    """Knows which arrays share memory, and what Python's own pickler cannot take."""

    def __init__(self, file: io.BytesIO, first: object, buffers: list[pickle.PickleBuffer]) -> None:
        super().__init__(file, PROTOCOL, buffer_callback=buffers.append)
        self._first, self._memories = first, dict[int, _Memory]()

    def reducer_override(self, obj: Any) -> Any:
        """Recipe to make an object again; `NotImplemented` for the usual way."""
        if obj is self._first:
            return object.__reduce_ex__(obj, PROTOCOL)
        if type(obj) is np.ndarray and not obj.dtype.hasobject:
            return self._array(obj)
        if type(obj) is MappingProxyType:
            return _proxy, (dict(obj),)
        return NotImplemented

    def _array(self, array: NDArray[Any]) -> Any:
        root: Any = array
        while isinstance(base := _looked_at(root), np.ndarray):
            root = base
        plain = root.flags.writeable and root.flags.c_contiguous
        if plain and root is array:
            return NotImplemented
        memory = root if plain else self._memories.setdefault(id(root), _Memory(root))
        offset = array.__array_interface__["data"][0] - root.__array_interface__["data"][0]
        like = array.shape, array.strides, array.dtype, array.flags.writeable
        return _view, (memory, offset, *like)
