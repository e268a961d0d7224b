"""Compiled kernels, as `mjforage.base.compiled` makes them."""

from mjforage.base.compiled import kernel

__all__ = ["kernel"]
