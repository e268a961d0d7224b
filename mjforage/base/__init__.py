"""Foundations: errors, files, registries, randomness, compiled kernels, Ctrl-C."""
