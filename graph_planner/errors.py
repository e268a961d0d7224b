"""Errors of graph_planner that a user can mend."""


class WeightsError(ValueError):
    """A weight file that is missing, of another kind, or made for something else."""
