"""A short run, as a command."""

from collections.abc import Callable

Refused = Callable[..., str]
GREEDY = ("evaluate", "comb-port", "--policy", "greedy")
EVALUATE = (*GREEDY, "--episodes", 2, "--set", "horizon=8")
