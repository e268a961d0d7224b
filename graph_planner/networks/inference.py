"""Values of many rows in blocks of one size on one thread, so that the batch changes no bit.

Needs torch: imported only where weights are wanted.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
import torch
from numpy.typing import NDArray

from mjforage.graph_planner.networks.q_network import MOVES, MoveNetwork

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
    network: MoveNetwork, levels: Mapping[str, NDArray[np.uint8] | torch.Tensor]
) -> NDArray[np.float32]:
    """(row, 9) values of levels (row, ...), arrays or tensors anywhere."""
    rows = next(iter(levels.values())).shape[0]
    device = next(network.parameters()).device
    with torch.no_grad(), one_thread():
        whole = {name: _padded(level).to(device) for name, level in levels.items()}
        out = torch.empty((rows + -rows % BLOCK, MOVES), device=device)
        for first in range(0, rows, BLOCK):
            block = slice(first, first + BLOCK)
            out[block] = network({name: level[block] for name, level in whole.items()})
        values: NDArray[np.float32] = out[:rows].cpu().numpy()
    return values


def _padded(level: NDArray[np.uint8] | torch.Tensor) -> torch.Tensor:
    """Zeros behind the rows, so that all blocks are whole."""
    if isinstance(level, torch.Tensor):
        return torch.cat((level, level.new_zeros((-len(level) % BLOCK, *level.shape[1:]))))
    spare = np.zeros((-len(level) % BLOCK, *level.shape[1:]), np.uint8)
    return torch.from_numpy(np.concatenate((level, spare)))
