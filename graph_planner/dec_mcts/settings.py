"""Settings of the search of `dec-mcts`, as kernels read them."""

from typing import NamedTuple


class Effort(NamedTuple):
    """Options of the policy; counts, never time."""

    rounds: int  # in which distributions are exchanged
    simulations: int  # of each agent per round
    candidates: int  # sequences in a distribution
    samples: int  # of the others' sequences by which a distribution is updated
    discount: float  # worth of an item a decision later
    look_discount: float  # worth of a view a decision later
    explore: float  # factor of the confidence bound
    forget: float  # worth of a simulation one simulation later
    heat: float  # temperature at first, in ranges of the utility
    cool: float  # factor of the temperature from round to round
    rate: float  # of the gradient steps
    roam: float  # how much rollouts differ from the greedy one
    depth: int  # most stops, and moves, in a sequence
    trust: float  # decisions unheard of after which an agent is counted on half of the time
