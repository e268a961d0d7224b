"""The ground that everything stands on: compiled kernels, Ctrl-C."""
