"""The dueling network of the Double DQN. Needs torch: imported only where weights are wanted."""

import torch
from torch import Tensor, nn

from graph_planner.encodings import Shapes

MOVES = 9
WIDTH, HEAD = 192, 64  # units of the trunk and of each head; estimates
LEVELS = 255.0


class DuelingNetwork(nn.Module):
    """Q(picture, move) = V + A(move) - mean A (Wang et al. 2016), for one agent of a team.

    Maps (channel, row, column) go through two convolutions, everything is joined into a trunk of
    WIDTH numbers. Where the encoding has a row of features per move, one advantage head reads the
    trunk with each row, the same for all moves; else it reads the trunk for all moves at once.
    """

    def __init__(self, shapes: Shapes) -> None:
        """Build for arrays of these shapes, see `Encoder.shapes`."""
        super().__init__()
        self.pictures = [name for name, shape in shapes.items() if len(shape) == 3]
        self.maps = nn.ModuleDict({_key(name): _eye(shapes[name]) for name in self.pictures})
        self.flat = [name for name, shape in shapes.items() if len(shape) < 3]
        width = sum(_size(self.maps[_key(name)], shapes[name]) for name in self.pictures)
        width += sum(torch.Size(shapes[name]).numel() for name in self.flat)
        self.trunk = nn.Sequential(nn.Linear(width, WIDTH), nn.ReLU())
        self.value = nn.Sequential(nn.Linear(WIDTH, HEAD), nn.ReLU(), nn.Linear(HEAD, 1))
        features = shapes["moves"][1] if "moves" in shapes else 0
        self.read_trunk = nn.Linear(WIDTH, HEAD)
        self.read_move = nn.Linear(features, HEAD, bias=False) if features else None
        self.advantage = nn.Linear(HEAD, 1 if features else MOVES)

    def forward(self, levels: dict[str, Tensor]) -> Tensor:
        """(row, 9) values of levels (row, ...) uint8."""
        seen = {name: level.float() / LEVELS for name, level in levels.items()}
        parts = [self.maps[_key(name)](seen[name]) for name in self.pictures]
        parts += [seen[name].flatten(1) for name in self.flat]
        trunk = self.trunk(torch.cat(parts, dim=1))
        if self.read_move is None:
            advantage = self.advantage(torch.relu(self.read_trunk(trunk)))
        else:
            joined = self.read_trunk(trunk)[:, None] + self.read_move(seen["moves"])
            advantage = self.advantage(torch.relu(joined)).squeeze(2)
        values: Tensor = self.value(trunk) + advantage - advantage.mean(dim=1, keepdim=True)
        return values


def _key(name: str) -> str:
    """The name of an array as torch takes it, which keeps some for itself, such as `items`."""
    name = name.replace(".", "_")
    return f"{name}_" if hasattr(nn.ModuleDict, name) else name


def _eye(shape: tuple[int, ...]) -> nn.Module:
    return nn.Sequential(
        nn.Conv2d(shape[0], 16, 3, stride=2, padding=1),
        nn.ReLU(),
        nn.Conv2d(16, 32, 3, stride=2, padding=1),
        nn.ReLU(),
        nn.Flatten(),
    )


def _size(eye: nn.Module, shape: tuple[int, ...]) -> int:
    with torch.no_grad():
        return int(eye(torch.zeros(1, *shape)).numel())
