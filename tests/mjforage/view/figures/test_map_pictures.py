"""Pictures of maps: what is drawn, that files are small and readable, errors."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib import rcParams
from PIL import Image

from mjforage.base.errors import UserError
from mjforage.scenario.maps import GridMap, load_map
from mjforage.view.figures.map_pictures import map_figure, save_map_picture


def test_water_and_land_are_drawn() -> None:
    before = dict(rcParams)
    grid = load_map("comb_port")
    axes = map_figure([grid]).axes[0]
    colours = np.asarray(axes.images[0].get_array())
    water = colours[grid.navigable].reshape(-1, 4)
    land = np.unique(colours[~grid.navigable].reshape(-1, 4), axis=0)
    assert len(land) == 1
    assert not (water == land).all(axis=1).any()
    assert axes.get_title(loc="left") == "comb_port: 62 x 46 cells, 1297 nodes"
    assert dict(rcParams) == before


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (40, 1)])
def test_odd_shapes_can_be_drawn(tmp_path: Path, shape: tuple[int, int]) -> None:
    grid = GridMap("odd", np.ones(shape, np.bool_))
    save_map_picture([grid], tmp_path / "odd.png")
    with Image.open(tmp_path / "odd.png") as image:
        assert min(image.size) > 10


def test_picture_is_small_and_the_same_each_time(tmp_path: Path) -> None:
    grid = load_map("channels")
    for name in ("a.png", "b.png"):
        save_map_picture([grid], tmp_path / name)
    assert (tmp_path / "a.png").stat().st_size < 100_000
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize("name", ["missing/picture.png", "picture.nonsense"])
def test_unwritable_picture_is_named(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError, match=name):
        save_map_picture([GridMap("sea", np.ones((2, 2), np.bool_))], tmp_path / name)
