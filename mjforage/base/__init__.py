"""The ground that everything stands on: compiled kernels and where they are kept."""
