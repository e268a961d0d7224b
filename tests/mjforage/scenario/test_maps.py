"""Map loading: shipped maps, bad input by name, images, components, starts."""

import logging
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from mjforage.base.errors import UserError
from mjforage.mission.mission import Mission
from mjforage.mission.setup import Setup
from mjforage.scenario import assets
from mjforage.scenario.map_files import shipped_maps
from mjforage.scenario.maps import (
    check_starts,
    components,
    load_map,
    load_starts,
)
from mjforage.scenario.scenario_file import load_scenario

Cells = NDArray[np.bool_]
WriteMap = Callable[..., str]

SMALL = np.array([[1, 1, 0], [0, 1, 0]], np.bool_)


@pytest.fixture
def write(tmp_path: Path) -> WriteMap:
    def _write(content: str | bytes, name: str = "harbour.csv") -> str:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return str(path)

    return _write


def table(cells: Cells, separator: str = ",", end: str = "\n") -> str:
    return "".join(separator.join(str(int(v)) for v in row) + end for row in cells)


@pytest.mark.parametrize(
    ("name", "shape", "nodes"),
    [
        ("comb_port", (62, 46), 1297),
        ("open_bay", (48, 64), 1954),
        ("channels", (56, 56), 1023),
    ],
)
@pytest.mark.parametrize("corner_cutting", [False, True])
def test_shipped_map_is_what_it_says(
    name: str, shape: tuple[int, int], nodes: int, corner_cutting: bool
) -> None:
    grid = load_map(name, corner_cutting=corner_cutting)
    assert (grid.name, grid.navigable.shape, grid.nodes) == (name, shape, nodes)
    assert components(grid.navigable, corner_cutting)[1].tolist() == [nodes]


@pytest.mark.parametrize("name", shipped_maps())
def test_every_shipped_map_is_one_component_and_fits_the_default_mission(name: str) -> None:
    grid = load_map(name, corner_cutting=False)
    assert components(grid.navigable, False)[1].tolist() == [grid.nodes]
    scenario = load_scenario("comb-port", ("horizon=2", "map.starts=[]"), map_file=name)
    mission = Mission(Setup.of(scenario))
    mission.reset(0, np.arange(2))
    assert (mission.state.agent_node >= 0).all()


def test_every_shipped_map_is_listed_and_found_with_dashes() -> None:
    files = (assets.models_folder() / "maps").iterdir()
    names = {f.name.removesuffix(".csv") for f in files if f.name.count(".") == 1}
    assert set(shipped_maps()) == names >= {"channels", "comb_port", "open_bay"}
    assert list(shipped_maps()) == sorted(names)
    assert np.array_equal(load_map("comb-port").navigable, load_map("comb_port").navigable)


def test_published_starts_are_on_water_in_our_comb_port() -> None:
    cells = load_map("comb_port").navigable
    starts = ((10, 7), (12, 7), (14, 7), (16, 7))
    check_starts(starts, cells, "scenario published", "comb_port")
    assert all(cells[start] for start in starts)


def test_loaded_map_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        load_map("comb_port").navigable[0, 0] = True


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        ("comb_prt", "did you mean comb_port?"),
        ("no/such/Channels.csv", "did you mean channels?"),
        (
            "zzz.csv",
            f"nor a file of a table or an image, or a place; choose {', '.join(shipped_maps())}",
        ),
        ("", "neither a shipped map"),
        ("x" * 5000, "map xxx"),
    ],
)
def test_missing_map_is_named(reference: str, message: str) -> None:
    with pytest.raises(UserError) as caught:
        load_map(reference)
    assert message in str(caught.value)
    assert f"map {reference}" in str(caught.value)


def test_corners_join_only_where_cutting_is_allowed(write: WriteMap) -> None:
    file = write("1,0\n0,1\n")
    assert load_map(file, corner_cutting=True).nodes == 2
    with pytest.raises(UserError, match=r"map\.corner_cutting = true"):
        load_map(file)


def test_separate_components_are_counted_and_the_largest_offered(
    write: WriteMap, caplog: pytest.LogCaptureFixture
) -> None:
    file = write("1,1,0,1\n1,0,0,0\n0,0,1,1\n")
    with pytest.raises(UserError) as caught:
        load_map(file)
    assert str(caught.value) == (
        "map harbour.csv: its 6 nodes form 3 separate components, of 3, 2, 1 nodes; "
        "keep only that one where you play on it: give map.largest_component = true"
    )
    with caplog.at_level(logging.WARNING):
        grid = load_map(file, largest_component=True)
    assert grid.navigable.astype(int).tolist() == [[1, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0]]
    assert "3 of 6 nodes lie outside the largest of 3 components" in caplog.text


def _image(mode: str) -> Image.Image:
    """One light and one dark pixel, as near to the threshold as the mode allows."""
    if mode == "I;16":
        return Image.fromarray(np.array([[32768, 32767]], np.uint16))
    if mode == "RGBA":  # black, but transparent; black and opaque
        return Image.fromarray(np.array([[[0, 0, 0, 0], [0, 0, 0, 255]]], np.uint8))
    if mode == "RGB":
        return Image.fromarray(np.array([[[128] * 3, [127] * 3]], np.uint8))
    if mode == "1":
        return Image.fromarray(np.array([[True, False]]))
    return Image.fromarray(np.array([[128, 127]], np.uint8)).convert(mode)


@pytest.mark.parametrize("mode", ["L", "LA", "RGB", "RGBA", "P", "1", "I;16"])
def test_half_of_white_is_the_threshold(tmp_path: Path, mode: str) -> None:
    path = tmp_path / "harbour.PNG"
    _image(mode).save(path)
    assert load_map(str(path)).navigable.tolist() == [[True, False]]


NO_PIXELS = b"GIF89a" + bytes(7) + b"\x2c" + bytes(9) + b"\x02\x00\x3b"


@pytest.mark.parametrize("content", [b"", b"1,1\n", b"\x89PNG\r\n\x1a\n" + bytes(40), NO_PIXELS])
def test_bad_image_is_named(write: WriteMap, content: bytes) -> None:
    with pytest.raises(UserError, match=r"map harbour\.png: is no image, or one of size 0, or dam"):
        load_map(write(content, "harbour.png"))


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    content=st.text("01,; \t\n.e-x\ufeff#\"'", max_size=60)
    | st.binary(max_size=60)
    | st.builds(bytes.__add__, st.just(b"P5\n2 2\n255\n"), st.binary(max_size=60))
)
def test_any_content_loads_or_is_a_user_error(write: WriteMap, content: str | bytes) -> None:
    for name in ("csv", "png", "pgm", "tif", "npy"):
        name = f"harbour.{name}"
        try:
            assert load_map(write(content, name)).navigable.any()
        except UserError as error:
            assert name in str(error)


@pytest.mark.parametrize(
    ("starts", "fault"),
    [
        (((0, 0), (0, 2)), "start (0, 2) of scenario published is on land in map foo.csv"),
        (((2, 0),), "start (2, 0) of scenario published is outside map foo.csv (2 rows x 3"),
        (((0, -1),), "start (0, -1) of scenario published is outside"),
        (((0, 0), (0, 0)), "start (0, 0) of scenario published is given twice"),
    ],
)
def test_bad_start_is_named_with_its_remedy(
    starts: tuple[tuple[int, int], ...], fault: str
) -> None:
    with pytest.raises(UserError) as caught:
        check_starts(starts, SMALL, "scenario published", "foo.csv")
    assert fault in str(caught.value)
    assert str(caught.value).endswith("give map.starts = [[r,c],...], or [] for a random cluster")


def test_starts_beside_a_map_are_read(write: WriteMap) -> None:
    file = write(table(SMALL))
    assert load_starts(file) is None
    write("\ufeff0,1\r\n\r\n 1 ; 1\r\n", "harbour.starts.csv")
    assert load_starts(file) == ((0, 1), (1, 1))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("0,1\n1\n", "line 2 is '1', expected two whole numbers: row,column"),
        ("0,1,2\n", "line 1 is '0,1,2'"),
        ("0,1.5\n", "line 1 is '0,1.5'"),
        ("row,column\n", "line 1 is 'row,column'"),
        ("\n", "is empty"),
        (b"\xff\xfe1", "cannot be read"),
    ],
)
def test_bad_starts_file_is_named(write: WriteMap, content: str | bytes, message: str) -> None:
    write(content, "harbour.starts.csv")
    with pytest.raises(UserError) as caught:
        load_starts(write(table(SMALL)))
    assert str(caught.value).startswith("starts harbour.starts.csv: ")
    assert message in str(caught.value)
