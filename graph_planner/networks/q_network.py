"""Networks that weigh an agent's moves. Needs torch: imported only where weights are wanted."""

from typing import ClassVar

import torch
from torch import Tensor, nn

from mjforage.graph_planner.encodings import Shapes

MOVES = 9
WIDTH, HEAD = 192, 64  # units of the trunk and of each head; estimates
LEVELS = 255.0


class MoveNetwork(nn.Module):
    """A preference of every move, for one agent of a team.

    Maps (channel, row, column) go through two convolutions, everything is joined into a trunk of
    WIDTH numbers. Where the encoding has a row of features per move, one head reads the trunk with
    each row, the same for all moves; else it reads the trunk for all moves at once.
    """

    dueling: ClassVar[bool] = False  # whether it has a head for the value of the state

    def __init__(self, shapes: Shapes) -> None:
        """Build for arrays of these shapes, see `Encoder.shapes`."""
        super().__init__()
        self.pictures = [name for name, shape in shapes.items() if len(shape) == 3]
        self.maps = nn.ModuleDict({key_of(name): eye(shapes[name]) for name in self.pictures})
        self.flat = [name for name, shape in shapes.items() if len(shape) < 3]
        width = sum(eye_size(self.maps[key_of(name)], shapes[name]) for name in self.pictures)
        width += sum(torch.Size(shapes[name]).numel() for name in self.flat)
        self.trunk = nn.Sequential(nn.Linear(width, WIDTH), nn.ReLU())
        if self.dueling:
            self.value = nn.Sequential(nn.Linear(WIDTH, HEAD), nn.ReLU(), nn.Linear(HEAD, 1))
        features = shapes["moves"][1] if "moves" in shapes else 0
        self.read_trunk = nn.Linear(WIDTH, HEAD)
        self.read_move = nn.Linear(features, HEAD, bias=False) if features else None
        self.advantage = nn.Linear(HEAD, 1 if features else MOVES)

    def forward(self, levels: dict[str, Tensor]) -> Tensor:
        """(row, 9) preferences by levels (row, ...) uint8: of a policy gradient's actor, logits."""
        seen = {name: level.float() / LEVELS for name, level in levels.items()}
        return self._preferences(self._joined(seen), seen)

    def _joined(self, seen: dict[str, Tensor]) -> Tensor:
        """(row, WIDTH) the trunk, of what is seen in [0, 1]."""
        parts = [self.maps[key_of(name)](seen[name]) for name in self.pictures]
        parts += [seen[name].flatten(1) for name in self.flat]
        trunk: Tensor = self.trunk(torch.cat(parts, dim=1))
        return trunk

    def _preferences(self, trunk: Tensor, seen: dict[str, Tensor]) -> Tensor:
        """(row, 9) the head."""
        if self.read_move is None:
            preferences: Tensor = self.advantage(torch.relu(self.read_trunk(trunk)))
        else:
            joined = self.read_trunk(trunk)[:, None] + self.read_move(seen["moves"])
            preferences = self.advantage(torch.relu(joined)).squeeze(2)
        return preferences


class DuelingNetwork(MoveNetwork):
    """Q(picture, move) = V + A(move) - mean A (Wang et al. 2016), A being the preferences."""

    dueling = True

    def forward(self, levels: dict[str, Tensor]) -> Tensor:
        """(row, 9) values of levels (row, ...) uint8."""
        seen = {name: level.float() / LEVELS for name, level in levels.items()}
        trunk = self._joined(seen)
        advantage = self._preferences(trunk, seen)
        values: Tensor = self.value(trunk) + advantage - advantage.mean(dim=1, keepdim=True)
        return values


def key_of(name: str) -> str:
    """The name of an array as torch takes it, which keeps some for itself, such as `items`."""
    name = name.replace(".", "_")
    return f"{name}_" if hasattr(nn.ModuleDict, name) else name


def eye(shape: tuple[int, ...]) -> nn.Module:
    """Two convolutions over a map (channel, row, column), their features in one row."""
    return nn.Sequential(
        nn.Conv2d(shape[0], 16, 3, stride=2, padding=1),
        nn.ReLU(),
        nn.Conv2d(16, 32, 3, stride=2, padding=1),
        nn.ReLU(),
        nn.Flatten(),
    )


def eye_size(convolutions: nn.Module, shape: tuple[int, ...]) -> int:
    """Features that an `eye` gives of a map of this shape."""
    with torch.no_grad():
        return int(convolutions(torch.zeros(1, *shape)).numel())
