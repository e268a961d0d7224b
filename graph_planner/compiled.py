"""Compiled kernels, as `mjforage.base.compiled` makes them."""

from mjforage.base.compiled import MARGIN, compiling, inlined, kernel, kinds_of, prepared, rough

__all__ = ["MARGIN", "compiling", "inlined", "kernel", "kinds_of", "prepared", "rough"]
