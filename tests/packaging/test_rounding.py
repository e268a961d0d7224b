"""Rounded weights: which ship so, and by how much rounding changes a number."""

from pathlib import Path

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.numpy import save_file

from mjforage.graph_planner.networks.weights import shipped_weights
from tests.packaging.rounding import DROPPED, round_file, rounded

ROUNDED = ("ddqn-reward", "mappo")


@pytest.mark.parametrize("name", ROUNDED)
def test_it_ships_rounded(name: str) -> None:
    with safe_open(shipped_weights(name), "np") as file:
        for tensor in (file.get_tensor(key) for key in list(file.keys())):
            assert not (tensor.view(np.uint32) % 2**DROPPED).any()


def test_rounding_is_to_the_nearest() -> None:
    values = np.random.default_rng(1).normal(size=1000).astype(np.float32)
    error = np.abs(rounded(values) / values - 1.0)
    assert 2.0**-16 < error.max() <= 2.0**-14
    np.testing.assert_array_equal(rounded(rounded(values)), rounded(values))
    np.testing.assert_array_equal(rounded(-values), -rounded(values))
    exact = np.array([0.0, 1.0, -2.5], np.float32)
    assert rounded(exact).tolist() == exact.tolist()


def test_a_file_keeps_its_names_shapes_and_note(tmp_path: Path) -> None:
    path = tmp_path / "some.safetensors"
    tensors = {"a": np.full((2, 3), np.pi, np.float32), "b": np.ones(4, np.float32)}
    save_file(tensors, path, metadata={"note": "text"})
    round_file(path)
    with safe_open(path, "np") as file:
        assert file.metadata() == {"note": "text"}
        for name, tensor in tensors.items():
            np.testing.assert_array_equal(file.get_tensor(name), rounded(tensor))
