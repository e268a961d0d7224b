"""Weight files of trained policies: safetensors with a header on their use.

The header can be read and checked without torch.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mjforage.base.errors import UserError, WeightsError
from mjforage.base.references import parse_reference
from mjforage.graph_planner.encodings import ENCODERS, Shapes, create_encoder, encoder_class
from mjforage.mission.task import Task
from mjforage.scenario.assets import models_folder

if TYPE_CHECKING:
    from torch import Tensor

    from mjforage.graph_planner.networks.q_network import MoveNetwork

Q_NETWORK = "mjforage dueling q-network 1"
ACTOR = "mjforage actor 1"
KINDS = {Q_NETWORK: "DuelingNetwork", ACTOR: "MoveNetwork"}
"""Format of a file -> class of `networks.q_network` that its weights are of."""
TEAMS = ("scout", "forager")
"""Networks of a file: for agents that do not collect, and for those that do."""

_LARGEST_HEADER = 1 << 20  # bytes
LARGEST = 1e4
"""Magnitude of a weight, those that ship being below 10: through five layers of some thousand
inputs, values in [0, 1] then stay finite in 32 bits."""
_NOTE = "mjforage"  # the one entry of the safetensors metadata, as several have no order


@dataclass(frozen=True)
class WeightsHeader:
    """Purpose of a weight file.

    Attributes
    ----------
    encoding : reference to an observation encoder
    shapes : of the arrays that the networks read
    grounds : maps and rules that they were trained on, see `ground_note`; empty: not known
    format : of `KINDS`: what the networks give for a move
    """

    encoding: str
    shapes: Shapes
    grounds: tuple[Mapping[str, Any], ...] = ()
    format: str = Q_NETWORK


def ground_note(task: Task) -> dict[str, Any]:
    """Identity of a map and its rules: a digest of the graph, and the move rules."""
    graph = task.graph
    found = hashlib.sha256(repr(graph.shape).encode())
    for array in (graph.rows, graph.cols, graph.neighbours):
        found.update(array.tobytes())
    return {"map": found.hexdigest()[:16], **asdict(task.rules)}


def shipped_weights(name: str) -> Path:
    """File of shipped weights. Raises `WeightsError` if there are none of that name."""
    path = models_folder() / "weights" / f"{name}.safetensors"
    if path.is_file():
        return path
    train = "train some with `mjforage train ddqn`"
    raise WeightsError(f"weights {name}: not found as {path}; {train}")


def read_header(path: Path) -> WeightsHeader:
    """Check a file's header.

    Raises `WeightsError` if the file is missing, not safetensors, or holds no weights of ours, or
    names an encoder of code that neither ships nor is installed, unless the user has named that
    (`mjforage.base.registry.trust`).
    """
    try:
        with path.open("rb") as file:
            size = int.from_bytes(file.read(8), "little")
            header = _parsed(file.read(size)) if size <= _LARGEST_HEADER else None
    except OSError as error:
        raise WeightsError(f"weights {path}: cannot be read ({error.strerror})") from error
    if not isinstance(header, dict):
        raise WeightsError(
            f"weights {path}: not a safetensors file; give one that `mjforage train` wrote"
        )
    notes = _notes(header.get("__metadata__"))
    encoding, kind = notes.get("perception"), notes.get("format")
    if not isinstance(kind, str) or kind not in KINDS or not isinstance(encoding, str):
        raise WeightsError(
            f"weights {path}: format {kind!r}, perception {encoding!r}; expected "
            f"{' or '.join(map(repr, KINDS))} and {', '.join(ENCODERS.names())} or "
            "package.module:Class"
        )
    try:
        ENCODERS.check_trusted(parse_reference(encoding, ENCODERS.kind).name, "header")
        encoder_class(encoding)
    except UserError as error:
        raise WeightsError(f"weights {path}: {error}") from error
    shapes: Any = notes.get("shapes")
    grounds: Any = notes.get("grounds", [])
    if not _are_shapes(shapes) or not _are_grounds(grounds):
        raise WeightsError(
            f"weights {path}: the header's shapes {shapes!r:.60} or grounds {grounds!r:.60} are "
            "not what `mjforage train` writes; get the file again"
        )
    arrays = {name: tuple(shape) for name, shape in shapes.items()}
    return WeightsHeader(encoding, arrays, tuple(grounds), kind)


def _parsed(text: Any) -> Any:
    """JSON; None where it is not."""
    try:
        return json.loads(text)
    except (TypeError, ValueError, RecursionError):
        return None


def _notes(metadata: Any) -> dict[str, Any]:
    """Safetensors metadata as `header_note` gave them."""
    notes = _parsed(metadata.get(_NOTE)) if isinstance(metadata, dict) else None
    return notes if isinstance(notes, dict) else {}


def _are_shapes(value: Any) -> bool:
    return isinstance(value, dict) and all(
        isinstance(shape, list) and shape and all(type(n) is int and n > 0 for n in shape)
        for shape in value.values()
    )


def _are_grounds(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(ground, dict) for ground in value)


def header_note(header: WeightsHeader) -> tuple[str, str]:
    """The header as an entry of safetensors metadata: key, and JSON text in a fixed order."""
    facts = asdict(header)
    facts["perception"] = facts.pop("encoding")  # as files have named it from the first
    return _NOTE, json.dumps(facts, sort_keys=True)


def load_networks(path: Path, task: Task) -> "dict[str, MoveNetwork]":
    """Team -> network with the file's weights, for a task; none for a team that it has not.

    Raises `WeightsError` if the file is damaged, made for arrays of another shape than the task's
    or, with a encoding that is bound to its map, for another map, or lacks a team of the task.
    """
    from safetensors import SafetensorError
    from safetensors.torch import load_file

    from mjforage.graph_planner.networks import q_network

    header = read_header(path)
    shapes = _check_fit(path, header, task)
    try:
        tensors = load_file(path)
    except SafetensorError as error:
        raise WeightsError(f"weights {path}: damaged ({error}); get the file again") from error
    present = {name.partition(".")[0] for name in tensors}
    made: type[MoveNetwork] = getattr(q_network, KINDS[header.format])
    networks = {team: made(shapes) for team in TEAMS if team in present}
    for team, agents in zip(TEAMS, (task.fleet.discoverers, task.fleet.collectors), strict=True):
        if agents.size and team not in networks:
            raise WeightsError(
                f"weights {path}: none for a {team}, which this scenario has; train with one"
            )
    _check_tensors(path, header.format, tensors, networks)
    for team, network in networks.items():
        start = f"{team}."
        own = {n.removeprefix(start): t for n, t in tensors.items() if n.startswith(start)}
        network.load_state_dict(own)
        network.train(False).requires_grad_(False)
    return networks


def _check_fit(path: Path, header: WeightsHeader, task: Task) -> Shapes:
    """Shapes in the encoder's order; weights that were made for something else are refused."""
    shapes = create_encoder(header.encoding, task).shapes
    if shapes != header.shapes:
        raise WeightsError(
            f"weights {path}: made for {header.encoding} arrays of {header.shapes}, but this "
            f"scenario's are {shapes}; use its own weights, or egocentric ones, which fit every map"
        )
    if getattr(encoder_class(header.encoding), "map_bound", False) and header.grounds:
        here = ground_note(task)
        if here not in header.grounds:
            raise WeightsError(
                f"weights {path}: {header.encoding} weights trained on "
                f"{' and '.join(str(dict(ground)) for ground in header.grounds)}, but this "
                f"scenario is {here}; use its own weights, or egocentric ones, which fit every map"
            )
    return shapes


def _check_tensors(
    path: Path, kind: str, tensors: "Mapping[str, Tensor]", networks: "Mapping[str, MoveNetwork]"
) -> None:
    """Refuse tensors that are missing, unknown, of another shape or type, or not finite or huge."""
    wanted = {
        f"{team}.{name}": _kind(value)
        for team, network in networks.items()
        for name, value in network.state_dict().items()
    }
    found = {name: _kind(value) for name, value in tensors.items()}
    for name in sorted(wanted | found):
        if wanted.get(name) != found.get(name):
            raise WeightsError(
                f"weights {path}: {name} is {found.get(name, 'missing')}, expected "
                f"{wanted.get(name, 'nothing of that name')} by {KINDS[kind]}; play a network of "
                "another class by a ModelPolicy, or train again if the file is of another version"
            )
        if not bool((tensors[name].abs() <= LARGEST).all()):  # nor what is no number
            raise WeightsError(
                f"weights {path}: {name} holds numbers that are not finite or beyond "
                f"+-{LARGEST:g}, with which values overflow; train again, or take an earlier "
                "checkpoint"
            )


def _kind(tensor: "Tensor") -> str:
    return f"{tuple(tensor.shape)} {str(tensor.dtype).removeprefix('torch.')}"
