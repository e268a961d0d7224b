"""Weight files of trained policies: safetensors with a header that says what they are for.

The header can be read and checked without torch.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from graph_planner.errors import WeightsError
from graph_planner.perception import PERCEPTIONS, Shapes
from graph_planner.task import Task

if TYPE_CHECKING:
    from torch import Tensor

    from graph_planner.q_network import DuelingNetwork

FORMAT = "mjforage dueling q-network 1"
TEAMS = ("scout", "forager")
"""Networks of a file: for agents that do not collect, and for those that do."""

_HERE = Path(__file__).resolve().parent
_PLACES = (_HERE.parent / "mjforage" / "models", _HERE.parent / "models")  # a wheel, a checkout
_LARGEST_HEADER = 1 << 20


@dataclass(frozen=True)
class WeightsHeader:
    """What a file is for.

    Attributes
    ----------
    perception : name in `PERCEPTIONS`
    shapes : of the arrays that the networks read
    """

    perception: str
    shapes: Shapes


def shipped_weights(name: str) -> Path:
    """File of shipped weights.

    Raises
    ------
    WeightsError
        If there are none of that name.
    """
    tried = [place / "weights" / f"{name}.safetensors" for place in _PLACES]
    for path in tried:
        if path.is_file():
            return path
    raise WeightsError(
        f"weights {name}: not found as {' or '.join(map(str, tried))}; train some with "
        "`mjforage train ddqn`"
    )


def read_header(path: Path) -> WeightsHeader:
    """Check a file's header.

    Raises
    ------
    WeightsError
        If the file is missing, not safetensors, or holds no weights of ours.
    """
    try:
        with path.open("rb") as file:
            size = int.from_bytes(file.read(8), "little")
            text = file.read(size) if size <= _LARGEST_HEADER else b""
        header = json.loads(text)
        notes = header.get("__metadata__", {})
    except OSError as error:
        raise WeightsError(f"weights {path}: cannot be read ({error.strerror})") from error
    except (ValueError, AttributeError) as error:
        raise WeightsError(
            f"weights {path}: not a safetensors file; give one that `mjforage train` wrote"
        ) from error
    if notes.get("format") != FORMAT or notes.get("perception") not in PERCEPTIONS:
        raise WeightsError(
            f"weights {path}: format {notes.get('format')!r}, perception "
            f"{notes.get('perception')!r}; expected {FORMAT!r} and one of {', '.join(PERCEPTIONS)}"
        )
    shapes = {name: tuple(shape) for name, shape in json.loads(notes["shapes"]).items()}
    return WeightsHeader(notes["perception"], shapes)


def header_notes(header: WeightsHeader) -> dict[str, str]:
    """The header as safetensors metadata."""
    return {
        "format": FORMAT,
        "perception": header.perception,
        "shapes": json.dumps(header.shapes),
    }


def load_networks(path: Path, task: Task) -> "dict[str, DuelingNetwork]":
    """Team -> network with the file's weights, for a task.

    Raises
    ------
    WeightsError
        If the file is damaged, or made for pictures of another shape than the task's.
    """
    from safetensors import SafetensorError
    from safetensors.torch import load_file

    from graph_planner.q_network import DuelingNetwork

    header = read_header(path)
    shapes = PERCEPTIONS[header.perception](task).shapes
    if shapes != header.shapes:
        raise WeightsError(
            f"weights {path}: made for {header.perception} arrays of {header.shapes}, but this "
            f"scenario's are {shapes}; use its own weights, or egocentric ones, which fit every map"
        )
    try:
        tensors: dict[str, Tensor] = load_file(path)
    except SafetensorError as error:
        raise WeightsError(f"weights {path}: damaged ({error}); get the file again") from error
    networks = {}
    for team in TEAMS:
        network = DuelingNetwork(shapes)
        own = {
            name.removeprefix(f"{team}."): tensor
            for name, tensor in tensors.items()
            if name.startswith(f"{team}.")
        }
        expected = {name: tuple(t.shape) for name, t in network.state_dict().items()}
        found = {name: tuple(t.shape) for name, t in own.items()}
        if found != expected:
            wrong = sorted(k for k in expected | found if expected.get(k) != found.get(k))[0]
            raise WeightsError(
                f"weights {path}: {team}.{wrong} has shape {found.get(wrong)}, expected "
                f"{expected.get(wrong)}; train again with this version"
            )
        if not all(bool(tensor.isfinite().all()) for tensor in own.values()):
            raise WeightsError(
                f"weights {path}: {team} holds numbers that are not finite; train again, or take "
                "an earlier checkpoint"
            )
        network.load_state_dict(own)
        networks[team] = network.train(False).requires_grad_(False)
    return networks
