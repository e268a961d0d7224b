"""Maps that several tests use."""

import numpy as np
import pytest
from scipy import ndimage

from mjforage.graph_planner.graph.navigation import NavigationGraph, navigation_graph


@pytest.fixture
def open_water() -> NavigationGraph:
    return navigation_graph(np.ones((15, 15), np.bool_), 4.0, False)


@pytest.fixture
def ragged_coast() -> NavigationGraph:
    """A connected random map: the largest part of 60 % water."""
    cells = np.random.default_rng(3).random((24, 31)) < 0.68
    label, _ = ndimage.label(cells)
    return navigation_graph(label == np.bincount(label.ravel())[1:].argmax() + 1, 4.0, False)
