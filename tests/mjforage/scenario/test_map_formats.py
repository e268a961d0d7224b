"""Map files as programs write them: small files as bytes, with the grid that each means."""

import io
import struct
import tracemalloc
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from mjforage.base.errors import UserError
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.mission.setup import Setup
from mjforage.scenario.map_files import WaterIs, read_cells
from mjforage.scenario.maps import load_map
from mjforage.scenario.scenario_file import load_scenario

Read = Callable[..., list[str]]

SEA = ["110", "011"]  # a map as rows of 0 and 1
PORT = ["11010", "01111", "01000"]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Rows of 0 and 1 of a file with this name and content."""

    def _read(name: str, content: str | bytes, water: WaterIs = "light") -> list[str]:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return ["".join("01"[int(cell)] for cell in row) for row in read_cells(path, name, water)]

    return _read


def cells(rows: list[str]) -> NDArray[np.uint8]:
    return np.array([[int(cell) for cell in row] for row in rows], np.uint8)


def image(array: NDArray[np.generic], kind: str, **options: object) -> bytes:
    file = io.BytesIO()
    Image.fromarray(array).save(file, kind, **options)
    return file.getvalue()


@pytest.mark.parametrize(
    "content",
    [
        "1,1,0\n0,1,1\n",
        "1;1;0\r\n0;1;1\r\n",
        "\ufeff1\t1\t0\n0\t1\t1",
        "# a port\n1 1 0\n#\n\n0 1 1\n",
        "1,1,0  # the north\n0,1,1\n",
        "True,True,False\nFalse,True,True\n",
        "true true FALSE\nfalse TRUE true\n",
        "255,255,0\n0,255,255\n",
        "255.0, 255.0, 0.0\n0.0, 255.0, 255.0\n",
    ],
)
@pytest.mark.parametrize("name", ["port.csv", "port.txt", "port"])
def test_a_text_as_programs_write_it(read: Read, name: str, content: str) -> None:
    assert read(name, content) == SEA


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("port.pgm", b"P5\n3 2\n255\n" + bytes([254, 254, 0, 205, 254, 254])),  # of map_server
        ("port.pgm", b"P2\n# c\n3 2\n255\n254 254 0\n205 206 255\n"),
        ("port.pgm", b"P2\n3 2\n1\n1 1 0\n0 1 1\n"),
        (
            "port.pgm",
            b"P5\n3 2\n65535\n" + struct.pack(">6H", 65535, 65000, 0, 52685, 65535, 65535),
        ),
        ("port.pbm", b"P1\n3 2\n0 0 1\n1 0 0\n"),
        ("port.ppm", b"P3\n3 2\n255\n" + b"255 255 255 " * 2 + b"0 0 0 " * 2 + b"250 255 255 " * 2),
        ("port.png", image(np.array([[254, 254, 0], [205, 254, 254]], np.uint8), "PNG")),
        ("port.png", image(np.array([[200, 205, 0], [9, 254, 254]], np.uint8), "PNG")),
        ("port.tif", image(np.array([[200, 205, 0], [9, 254, 254]], np.uint8), "TIFF")),
        ("port.webp", image(255 * cells(SEA), "WEBP", lossless=True)),
        ("port.tiff", image(255 * cells(SEA), "TIFF", compression="tiff_deflate")),
        ("port.tif", image(cells(SEA), "TIFF")),  # a mask of 0 and 1
        ("port.tif", image(cells(SEA).astype(bool), "TIFF")),
        ("port.tif", image(cells(SEA).astype(np.uint16), "TIFF")),
        ("port.tif", image(cells(SEA).astype(np.uint16) * 65535, "TIFF")),
        ("port.png", image(np.stack([255 * cells(SEA)] * 3, -1), "PNG")),
    ],
)
def test_an_image_as_programs_write_it(read: Read, name: str, content: bytes) -> None:
    assert read(name, content) == SEA


def test_what_map_server_does_not_know_is_land_and_said(
    read: Read, caplog: pytest.LogCaptureFixture
) -> None:
    served = b"P5\n2 2\n255\n" + bytes([254, 205, 205, 0])
    assert read("port.pgm", served) == ["10", "00"]
    assert "map port.pgm: 50 % of its pixels are unknown" in caplog.text
    assert read("port.pgm", served, "dark") == ["00", "01"]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("port.png", image(255 - 255 * cells(PORT), "PNG")),
        ("port.csv", "0,0,1,0,1\n1,0,0,0,0\n1,0,1,1,1\n"),
    ],
)
def test_dark_water(read: Read, name: str, content: str | bytes) -> None:
    assert read(name, content, "dark") == PORT


@pytest.mark.parametrize("water", ["light", "dark"])
def test_an_edge_of_water_is_told_with_the_other_reading(
    read: Read, caplog: pytest.LogCaptureFixture, water: WaterIs
) -> None:
    ring = np.full((4, 5), 255, np.uint8)
    ring[1:3, 2] = 0
    read("ring.png", image(ring if water == "light" else 255 - ring, "PNG"), water)
    other = {"light": "dark", "dark": "light"}[water]
    line = f"map ring.png: all of its edge is water; if that is the land, give map.water = {other}"
    assert caplog.messages == [line]
    caplog.clear()
    ring[0, 0] = 0
    read("ring.png", image(ring, "PNG"))
    read("sea.png", image(np.full((4, 5), 255, np.uint8), "PNG"))  # nothing is the other way round
    read("ring.csv", "1,1,1\n1,0,1\n1,1,1\n")  # a table says which is water
    assert caplog.messages == []


def test_the_water_of_a_scenario_goes_with_its_map(tmp_path: Path) -> None:
    (tmp_path / "chart.csv").write_text("0,0\n0,1\n")
    (tmp_path / "own.toml").write_text(
        'name = "own"\n[map]\nfile = "chart.csv"\nwater = "dark"\n'
        "[team.a]\ncount = 1\nmoves = 1\nradius = 1\ncollects = true\n"
    )
    own = str(tmp_path / "own.toml")
    assert Setup.of(load_scenario(own)).grid.nodes == 3
    assert load_scenario(own, map_file="comb_port").map.water == "light"
    assert EnvironmentOptions(scenario=own, map="comb_port").setup.grid.nodes == 1297
    chart = str(tmp_path / "chart.csv")
    assert Setup.of(load_scenario(own, map_file=chart, water="dark")).grid.nodes == 3
    assert Setup.of(load_scenario(own, ["map.water=dark"], chart)).grid.nodes == 3


@pytest.mark.parametrize("reference", ["comb_port", "harbour:combs:7"])
def test_maps_whose_water_is_known_are_not_turned_round(reference: str) -> None:
    with pytest.raises(
        UserError, match=f"map {reference}: has light water; leave out map.water = dark"
    ):
        load_map(reference, water="dark")


def png(width: int, height: int) -> bytes:
    """A grey PNG of one colour, written without its pixels ever being in memory."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return (
            struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        )

    packed, row = zlib.compressobj(1), bytes(width + 1)
    body = b"".join(packed.compress(row) for _ in range(height)) + packed.flush()
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def gif(width: int, height: int) -> bytes:
    """A GIF that says this size and holds one pixel."""
    size, colours = struct.pack("<HH", width, height), b"\0\0\0\xff\xff\xff"
    pixel = b"\x2c" + bytes(4) + size + b"\0\2\2\x4c\1\0\x3b"
    return b"GIF89a" + size + b"\x80\0\0" + colours + pixel


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        (
            "a.csv",
            "1,1\n255,0\n",
            "row 1, column 0 is '255', expected 0 or 1 (counted from 0)",
        ),
        (
            "a.csv",
            "# x\n255,0\n\n255\n",
            "row 1 has 1 columns, expected 2 (counted from 0; line 4)",
        ),
        ("a.csv", "# x\n255,0\n255,2\n", "row 1, column 1 is '2', expected 0 or 255"),
        ("a.csv", "a,1\n1,1\n", "row 0, column 0 is 'a'"),
        ("a.csv", "1,1,\n1,1,\n", "row 0, column 2 is '', expected 0 or 1"),
        ("a.csv", "# only\n#\n", "is empty"),
        (
            "a.npy",
            b"\x93NUMPY\x01",
            "is neither a text in UTF-8 nor, by the end of its name, an image",
        ),
        ("a.png", png(13_300, 13_300), "13300 x 13300 cells are more than 40,000,000; cut out"),
        ("a.png", png(19_000, 19_000), "has more pixels than the 40,000,000 cells"),
        ("a.gif", gif(20_000, 20_000), "more pixels than the 40,000,000 cells of a map; cut out"),
        ("a.pgm", b"P5\n13300 13300\n255\n", "13300 x 13300 cells are more than 40,000,000"),
        ("a.pgm", b"P5\n2 2\n255\n\x00", "cannot be read as an image"),
        ("a.tif", image(np.array([[0.5]], np.float32), "TIFF"), "cannot be read as an image"),
        ("a.tif", b"II*\x00", "is no image, or one of size 0, or damaged"),
    ],
)
def test_a_malformed_file_is_one_line_and_takes_no_memory(
    read: Read, name: str, content: str | bytes, words: str
) -> None:
    tracemalloc.start()
    try:
        with pytest.raises(UserError) as caught:
            read(name, content)
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
    finally:
        tracemalloc.stop()
    assert str(caught.value).startswith(f"map {name}: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
