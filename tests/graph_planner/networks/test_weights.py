import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from mjforage.base.errors import WeightsError
from mjforage.graph_planner.encodings import ENCODERS
from mjforage.graph_planner.graph.navigation import navigation_graph
from mjforage.graph_planner.networks.inference import BLOCK, values_of
from mjforage.graph_planner.networks.q_network import DuelingNetwork
from mjforage.graph_planner.networks.weights import (
    Q_NETWORK,
    TEAMS,
    WeightsHeader,
    ground_note,
    header_note,
    load_networks,
    read_header,
    shipped_weights,
)
from mjforage.graph_planner.policies.ddqn import QPolicy
from mjforage.mission.task import Task
from mjforage.scenario.roles import Role
from tests.graph_planner.driver import observation_of, task_of


def task(rows: int = 9, columns: int = 12) -> Task:
    graph = navigation_graph(np.ones((rows, columns), np.bool_), 1.0, True)
    return task_of(graph, scouts=Role(2, 2, 4.0, False), foragers=Role(1, 1, 1.0, True))


def write(
    path: Path, kind: str = "egocentric", changes: dict[str, torch.Tensor] | None = None
) -> Path:
    torch.manual_seed(0)
    shapes = ENCODERS.find(kind)(task()).shapes
    tensors = {
        f"{team}.{name}": value.clone()
        for team in TEAMS
        for name, value in DuelingNetwork(shapes).state_dict().items()
    }
    header = WeightsHeader(kind, shapes, (ground_note(task()),))
    save_file(tensors | (changes or {}), path, metadata=dict([header_note(header)]))
    return path


@pytest.mark.parametrize("kind", ["egocentric", "paper"])
def test_a_policy_reads_what_was_written(tmp_path: Path, kind: str) -> None:
    policy = QPolicy(write(tmp_path / "w.safetensors", kind))
    state = observation_of(task(), [(0, 0), (3, 3), (5, 5)], {(2, 2): 1}, episodes=3)
    policy.reset(task(), state.keys)
    values = policy.act(state)
    assert values.shape == (3, 3, 9)
    assert np.isfinite(values).all()
    np.testing.assert_array_equal(values[0], values[1])
    assert np.ptp(values[0, 0]) > 0.0


def test_egocentric_weights_fit_another_map(tmp_path: Path) -> None:
    assert load_networks(write(tmp_path / "w.safetensors"), task(20, 31)).keys() == set(TEAMS)


def test_paper_weights_of_another_map_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "w.safetensors", "paper")
    with pytest.raises(WeightsError, match=r"made for paper arrays of .*\(6, 9, 12\).*this sc"):
        load_networks(path, task(20, 31))


def test_paper_weights_are_bound_to_their_map_and_rules(tmp_path: Path) -> None:
    """Arrays of one size do not make two maps one; fleet and horizon may differ."""
    path = write(tmp_path / "w.safetensors", "paper")
    others = {"scouts": Role(3, 1, 2.0, False), "foragers": Role(2, 2, 3.0, True)}
    load_networks(path, task_of(task().graph, task().rules, horizon=7, **others))
    cells = np.ones((9, 12), np.bool_)
    cells[4, 4] = False
    other = replace(task(), graph=navigation_graph(cells, 1.0, True))
    stricter = replace(task(), rules=replace(task().rules, stay=not task().rules.stay))
    for wrong in (other, stricter):
        with pytest.raises(WeightsError, match=r"paper weights trained on .* but this scenario is"):
            load_networks(path, wrong)
        load_networks(write(tmp_path / "e.safetensors"), wrong)


def test_weights_without_a_team_are_for_fleets_without_it(tmp_path: Path) -> None:
    shapes = ENCODERS.find("egocentric")(task()).shapes
    network = DuelingNetwork(shapes)
    tensors = {f"forager.{name}": value for name, value in network.state_dict().items()}
    path = tmp_path / "w.safetensors"
    save_file(tensors, path, metadata=dict([header_note(WeightsHeader("egocentric", shapes))]))
    alone = task_of(task().graph, foragers=Role(2, 1, 1.0, True))
    assert load_networks(path, alone).keys() == {"forager"}
    with pytest.raises(WeightsError, match="none for a scout, which this scenario has"):
        load_networks(path, task())


def header_file(path: Path, metadata: object) -> Path:
    """Write a safetensors file with nothing but metadata."""
    text = json.dumps({"__metadata__": metadata}).encode()
    path.write_bytes(len(text).to_bytes(8, "little") + text)
    return path


NOTES = {"format": Q_NETWORK, "perception": "paper"}


def noted(**changes: object) -> dict[str, str]:
    return {"mjforage": json.dumps(NOTES | changes)}


@pytest.mark.parametrize(
    ("metadata", "words"),
    [
        (None, "format None"),
        ([1], "format None"),
        ({"mjforage": "none"}, "format None"),
        ({"mjforage": "[]"}, "format None"),
        (noted(perception=["paper"]), r"perception \['paper'\]"),
        (noted(), "shapes None"),
        (noted(shapes=[1]), r"shapes \[1\]"),
        (noted(shapes={"map": 3}), "shapes {'map': 3}"),
        (noted(shapes={"map": [6, -1, 2]}), "shapes {'map'"),
        (noted(shapes={"map": [6, 9, 12]}, grounds="x"), "grounds 'x'"),
    ],
)
def test_headers_of_others_are_named(tmp_path: Path, metadata: object, words: str) -> None:
    with pytest.raises(WeightsError, match=words):
        read_header(header_file(tmp_path / "w.safetensors", metadata))


def test_what_is_no_weight_file_is_named(tmp_path: Path) -> None:
    missing = tmp_path / "none.safetensors"
    with pytest.raises(WeightsError, match=r"none.safetensors: cannot be read \(No such file"):
        QPolicy(missing)
    pickled = tmp_path / "model.pt"
    torch.save({"a": torch.zeros(1)}, pickled)
    with pytest.raises(WeightsError, match=r"model.pt: not a safetensors file"):
        QPolicy(pickled)
    deep = tmp_path / "deep.safetensors"
    deep.write_bytes((1 << 19).to_bytes(8, "little") + b"[" * (1 << 19))
    with pytest.raises(WeightsError, match=r"deep.safetensors: not a safetensors file"):
        QPolicy(deep)
    other = tmp_path / "other.safetensors"
    save_file({"a": torch.zeros(1)}, other)
    with pytest.raises(WeightsError, match=r"other.safetensors: format None"):
        QPolicy(other)
    with pytest.raises(WeightsError, match=r"weights nobody: not found as .* train some with"):
        shipped_weights("nobody")


def test_tensors_of_another_shape_and_cut_files_are_named(tmp_path: Path) -> None:
    wrong = write(tmp_path / "w.safetensors", changes={"scout.value.2.bias": torch.zeros(7)})
    with pytest.raises(
        WeightsError, match=r"scout.value.2.bias is \(7,\) float32, expected \(1,\) f"
    ):
        load_networks(wrong, task())
    half = write(tmp_path / "h.safetensors", changes={"scout.value.2.bias": torch.zeros(1).half()})
    with pytest.raises(WeightsError, match=r"is \(1,\) float16, expected \(1,\) float32"):
        load_networks(half, task())
    more = write(tmp_path / "m.safetensors", changes={"captain.bias": torch.zeros(1)})
    with pytest.raises(WeightsError, match=r"captain.bias is .* expected nothing of that name"):
        load_networks(more, task())
    cut = tmp_path / "cut.safetensors"
    cut.write_bytes(write(tmp_path / "v.safetensors").read_bytes()[:-100])
    with pytest.raises(WeightsError, match=r"cut.safetensors: damaged"):
        load_networks(cut, task())
    assert read_header(cut).encoding == "egocentric"
    nothing = torch.full((1,), torch.nan)
    spoilt = write(tmp_path / "u.safetensors", changes={"forager.value.2.bias": nothing})
    with pytest.raises(
        WeightsError, match=r"forager.value.2.bias holds numbers that are not finite"
    ):
        load_networks(spoilt, task())


@pytest.mark.every_capability
def test_the_batch_changes_no_bit_of_a_value() -> None:
    torch.manual_seed(1)
    shapes = ENCODERS.find("egocentric")(task()).shapes
    network, random = DuelingNetwork(shapes), np.random.default_rng(0)
    rows = 2 * BLOCK + 5
    levels = {n: random.integers(0, 256, (rows, *s)).astype(np.uint8) for n, s in shapes.items()}
    whole, order = values_of(network, levels), random.permutation(rows)
    shuffled = values_of(network, {name: level[order] for name, level in levels.items()})
    assert whole[order].tobytes() == shuffled.tobytes()
    for i in (0, 31, 32, rows - 1):
        one = values_of(network, {name: level[i : i + 1] for name, level in levels.items()})
        assert one.tobytes() == whole[i : i + 1].tobytes()


@pytest.mark.every_capability
def test_the_network_is_dueling() -> None:
    """Q less its mean over moves is the advantage less its mean: the value shifts all alike."""
    torch.manual_seed(0)
    shapes = ENCODERS.find("egocentric")(task()).shapes
    network = DuelingNetwork(shapes)
    levels = {name: torch.randint(0, 256, (4, *s), dtype=torch.uint8) for name, s in shapes.items()}
    before = network(levels)
    with torch.no_grad():
        network.get_parameter("value.2.bias").add_(3.0)
    torch.testing.assert_close(network(levels), before + 3.0)
