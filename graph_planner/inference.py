"""Values of many rows in blocks of one size on one thread, so that the batch changes no bit.

Needs torch: imported only where weights are wanted.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
import torch
from numpy.typing import NDArray

from graph_planner.q_network import MOVES, DuelingNetwork

BLOCK = 32  # rows; a last, shorter block is padded with zeros


@contextmanager
def one_thread() -> Iterator[None]:
    """Torch on one thread for a while: sums then have one order."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def values_of(
    network: DuelingNetwork, levels: Mapping[str, NDArray[np.uint8]]
) -> NDArray[np.float32]:
    """(row, 9) values of levels (row, ...)."""
    rows = next(iter(levels.values())).shape[0]
    out = np.empty((rows, MOVES), np.float32)
    device = next(network.parameters()).device
    with torch.no_grad(), one_thread():
        for first in range(0, rows, BLOCK):
            count = min(BLOCK, rows - first)
            block = {}
            for name, level in levels.items():
                padded = np.zeros((BLOCK, *level.shape[1:]), np.uint8)
                padded[:count] = level[first : first + count]
                block[name] = torch.from_numpy(padded).to(device)
            out[first : first + count] = network(block)[:count].cpu().numpy()
    return out
