"""Map files as programs write them: small files as bytes, with the grid that each means."""

import io
import logging
import struct
import tracemalloc
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, TiffImagePlugin

from mjforage.base.errors import UserError
from mjforage.learning.environments.options import EnvironmentOptions
from mjforage.mission.setup import Setup
from mjforage.scenario.map_files import WaterIs, read_cells
from mjforage.scenario.map_formats.levels import MOST_CELLS
from mjforage.scenario.maps import load_map
from mjforage.scenario.scenario_file import load_scenario

Read = Callable[..., list[str]]

SEA = ["110", "011"]  # a map as rows of 0 and 1
PORT = ["11010", "01111", "01000"]  # wide enough to be told from a count


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Rows of 0 and 1 of a file with this name and content."""

    def _read(name: str, content: str | bytes, water: WaterIs = "light") -> list[str]:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return ["".join("01"[int(cell)] for cell in row) for row in read_cells(path, name, water)]

    return _read


def npy(array: NDArray[np.generic], **options: bool) -> bytes:
    file = io.BytesIO()
    np.save(file, array, **options)
    return file.getvalue()


def cells(rows: list[str]) -> NDArray[np.uint8]:
    return np.array([[int(cell) for cell in row] for row in rows], np.uint8)


def image(array: NDArray[np.generic], kind: str, **options: object) -> bytes:
    file = io.BytesIO()
    Image.fromarray(array).save(file, kind, **options)
    return file.getvalue()


@pytest.mark.parametrize(
    "content",
    [
        "1,1,0,\n0,1,1,\n",  # a separator after every field
        "1;1;0;\n0;1;1;\n",
        '"1","1","0"\n"0","1","1"\n',
        "'1' '1' '0'\n'0' '1' '1'\n",
        "# a port\n1,1,0\n#\n0,1,1\n",
        "1,1,0  # the north\n0,1,1\n",
        "True,True,False\nFalse,True,True\n",
        "true true FALSE\nfalse TRUE true\n",
        "255,255,0\n0,255,255\n",
        "255.0,255.0,0.0\n0.0,255.0,255.0\n",
        "a,b,c\n1,1,0\n0,1,1\n",
        "1,0;1,0;0,0\n0,0;1,0;1,0\n",  # of a European spreadsheet
        ";a;b, c;d\nnorth;1;1;0\nsouth;0;1;1\n",
        "sep=;\n1;1;0\n0;1;1\n",
        ",0,1,2\n0,1,1,0\n1,0,1,1\n",
        ",a,b,c\nnorth,1,1,0\nsouth,0,1,1\n",
        '"","V1","V2","V3"\n"1",1,1,0\n"2",0,1,1\n',
        "0,1,2\n1,1,0\n0,1,1\n",
        "# of pandas\n   0  1  2\n0  1  1  0\n1  0  1  1\n",
        "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 4\n1 1 0\n0 1 1\n",
        "NCOLS 3\nNROWS 2\nXLLCENTER 0\nYLLCENTER 0\nCELLSIZE 4\nNODATA_value -1\n1 1 -1\n-1 1 1\n",
        "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 4\n255 255 -9999\n0 255\n255\n",
        "type octile\nheight 2\nwidth 3\nmap\n.G@\nTSG\n",
        "type octile\r\nheight 2\r\nwidth 3\r\nmap\r\n..W\r\nO..\r\n",
    ],
)
@pytest.mark.parametrize("name", ["port.csv", "port.map", "port.asc"])
def test_a_text_as_programs_write_it(read: Read, name: str, content: str) -> None:
    assert read(name, content) == SEA


@pytest.mark.parametrize("mark", ["utf-16-le", "utf-16-be"])
def test_a_text_in_utf_16_as_spreadsheets_write_it(read: Read, mark: str) -> None:
    assert read("port.csv", "\ufeffNäht;b;c\r\n1;1;0\r\n0;1;1\r\n".encode(mark)) == SEA
    with pytest.raises(UserError, match=r"map port\.csv: is neither UTF-8 nor UTF-16 text"):
        read("port.csv", "\ufeff1;1".encode(mark) + b"1")


def test_cells_of_an_array_without_a_value_are_land(read: Read) -> None:
    array = np.array([[1.0, np.nan, 0.0]])
    assert read("port.npy", npy(array)) == ["100"]
    assert read("port.npy", npy(array), "dark") == ["001"]


def frame(rows: list[str], spelt: str, separator: str, header: bool, index: bool) -> str:
    """What `to_csv` of a pandas data frame writes; `spelt` are its words for 0 and 1."""
    words = [[spelt.split()[int(cell)] for cell in row] for row in rows]
    if header:
        words = [[str(column) for column in range(len(words[0]))], *words]
    if index:
        first = ["", *map(str, range(len(rows)))] if header else [*map(str, range(len(rows)))]
        words = [[label, *row] for label, row in zip(first, words, strict=True)]
    return "".join(separator.join(row) + "\n" for row in words)


@pytest.mark.parametrize("header", [True, False])
@pytest.mark.parametrize("index", [True, False])
@pytest.mark.parametrize("spelt", ["0 1", "0.0 1.0", "False True", "0 255"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_data_frame_is_read_with_header_and_index(
    read: Read, header: bool, index: bool, spelt: str, separator: str
) -> None:
    assert read("frame.csv", frame(PORT, spelt, separator, header, index)) == PORT


@pytest.mark.parametrize("kind", [bool, np.uint8, np.int64, np.float32, ">i2"])
@pytest.mark.parametrize("top", [1, 255])
def test_an_array_of_numpy(read: Read, kind: str, top: int) -> None:
    assert read("port.npy", npy((top * cells(PORT).astype(int)).astype(kind))) == PORT
    assert read("port.npy", npy(np.asfortranarray(cells(PORT)))) == PORT


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
        ("port.tif", image(cells(SEA).astype(np.float32), "TIFF")),
        ("port.tif", image(cells(SEA).astype(bool), "TIFF")),
        ("port.tif", image(cells(SEA).astype(np.uint16), "TIFF")),
        ("port.tif", image(cells(SEA).astype(np.uint16) * 65535, "TIFF")),
        ("port.png", image(np.stack([255 * cells(SEA)] * 3, -1), "PNG")),
    ],
)
def test_an_image_as_programs_write_it(read: Read, name: str, content: bytes) -> None:
    assert read(name, content) == SEA


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_cells_of_a_geotiff_without_a_value_are_land(read: Read, kind: type) -> None:
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    tags[42113] = "7"
    values: NDArray[np.generic] = np.array([[1, 1, 7], [0, 1, 1]], kind)
    assert read("port.tif", image(values, "TIFF", tiffinfo=tags)) == SEA
    assert read("port.tif", image(values, "TIFF", tiffinfo=tags), "dark") == ["000", "100"]


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
        ("port.csv", frame(PORT, "1 0", ",", header=True, index=True)),
        ("port.npy", npy(~cells(PORT).astype(bool))),
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
    line = f"map ring.png: all of its edge is water; if that is the land, give --water {other}"
    assert caplog.messages == [line]
    caplog.clear()
    ring[0, 0] = 0
    read("ring.png", image(ring, "PNG"))
    read("sea.npy", npy(np.ones((3, 3))))  # nothing is the other way round there
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
        UserError, match=f"map {reference}: has light water; leave out --water dark"
    ):
        load_map(reference, water="dark")


def png(width: int, height: int) -> bytes:
    """A grey PNG of one colour, written without its pixels ever being in memory."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return (
            struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        )

    packed, row = zlib.compressobj(9), bytes(width + 1)
    body = b"".join(packed.compress(row) for _ in range(height)) + packed.flush()
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def gif(width: int, height: int) -> bytes:
    """A GIF that says this size and holds one pixel."""
    size, colours = struct.pack("<HH", width, height), b"\0\0\0\xff\xff\xff"
    pixel = b"\x2c" + bytes(4) + size + b"\0\2\2\x4c\1\0\x3b"
    return b"GIF89a" + size + b"\x80\0\0" + colours + pixel


def huge_npy(shape: tuple[int, int]) -> bytes:
    head = f"{{'descr': '|b1', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode()


class Spoilt:
    """Unpickled, it would raise."""

    def __reduce__(self) -> tuple[Callable[[str], None], tuple[str]]:
        return pytest.fail, ("it was unpickled",)


ESRI = "ncols {}\nnrows {}\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
OCTILE = "type octile\nheight {}\nwidth {}\nmap\n"


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        (
            "a.csv",
            "1,1\n255,0\n",
            "row 1, column 0 is '255', expected 0 or 1 (counted from 0; line 2)",
        ),
        (
            "a.csv",
            "# x\n255,0\n\n255,2\n",
            "row 1 has 0 columns, expected 2 (counted from 0; line 3)",
        ),
        ("a.csv", "# x\n255,0\n255,2\n", "row 1, column 1 is '2', expected 0 or 255"),
        ("a.csv", "a,1\n1,1\n", "row 0, column 0 is 'a'"),
        ("a.csv", "a,b\nc,d\n", "row 0, column 0 is 'c', expected 0 or 1 (counted from 0; line 2)"),
        ("a.csv", "# only\n#\n", "is empty"),
        ("a.asc", "ncols 2\nxllcorner 0\n1 1\n", "its header needs nrows and a whole number"),
        ("a.asc", ESRI.format(2, 2) + "1 1 1\n", "has 3 cells, its header says 2 x 2"),
        ("a.asc", ESRI.format(2, 1) + "1 x\n", "could not convert string to float: 'x'; give"),
        ("a.asc", ESRI.format(2, 1) + "1 -7.5\n", "row 0, column 1 is -7.5, expected 0 or 1"),
        ("a.asc", ESRI.format(99999, 99999) + "1", "99999 x 99999 cells are more than 40,000,000"),
        ("a.asc", ESRI.format(0, 1), "1 x 0 cells; give at least one row and column"),
        ("a.map", "type tile\nheight 1\nwidth 1\nmap\n.\n", "its header needs type octile, height"),
        (
            "a.map",
            "type octile\nheight 1\nwidth 1\n",
            "its header needs type octile, height, width",
        ),
        ("a.map", OCTILE.format("x", 2) + "..\n", "its header needs height and a whole number"),
        (
            "a.map",
            OCTILE.format(2, 2) + "..\n",
            "has 1 rows of 2 characters, its header says 2 x 2",
        ),
        ("a.map", OCTILE.format(1, 2) + ".?\n", "row 0 has '?', expected .GS or @OTW (counted fr"),
        ("a.map", OCTILE.format(10**6, 10**6), "1000000 x 1000000 cells are more than 40,000,000"),
        ("a.npy", npy(np.ones(3)), "is no array (row, column) of numbers"),
        ("a.npy", npy(np.array([["a"]])), "is no array (row, column) of numbers"),
        (
            "a.npy",
            npy(np.array([[0, 7]])),
            "row 0, column 1 is 7, expected 0 or 1 (counted from 0)",
        ),
        ("a.npy", npy(np.ones((1, 1))[:, :0]), "1 x 0 cells; give at least one row and column"),
        ("a.npy", npy(np.array([[Spoilt()]]), allow_pickle=True), "is no array (row, column) of"),
        ("a.npy", b"\x93NUMPY\x01", "is damaged, or no array"),
        ("a.npy", b"PK\x03\x04", "is damaged, or no array"),
        ("a.npy", b"1,1\n", "is damaged, or no array"),
        ("a.npy", huge_npy((6000, 6000)), "is damaged, or no array"),
        ("a.npy", huge_npy((10**30, 10**30)), "cells are more than 40,000,000"),
        ("a.png", png(13_300, 13_300), "13300 x 13300 cells are more than 40,000,000; cut out"),
        ("a.png", png(19_000, 19_000), "has more pixels than the 40,000,000 cells"),
        ("a.gif", gif(20_000, 20_000), "more pixels than the 40,000,000 cells of a map; cut out"),
        ("a.pgm", b"P5\n13300 13300\n255\n", "13300 x 13300 cells are more than 40,000,000"),
        ("a.pgm", b"P5\n2 2\n255\n\x00", "cannot be read as an image"),
        ("a.tif", image(np.array([[0.5]], np.float32), "TIFF"), "row 0, column 0 is 0.5, expected"),
        ("a.yaml", "image: a.pgm\n", "only describes a map of map_server; give the image that"),
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


def test_as_many_cells_as_a_map_may_have_are_more_than_any_machine_plays() -> None:
    assert 6000 * 6000 < MOST_CELLS < 13_300 * 13_300


def test_a_large_map_says_what_it_will_cost(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    np.save(tmp_path / "sea.npy", np.ones((550, 550), bool))
    with caplog.at_level(logging.WARNING):
        setup = Setup.of(load_scenario("comb-port", ["map.starts=[]"], str(tmp_path / "sea.npy")))
        Setup.of(setup.scenario)
    (line,) = caplog.messages
    assert line.startswith("map sea.npy: 302,500 nodes take about 0.2 GB and 4 s to prepare, then ")
    views, graph = setup.task.views, setup.graph
    taken = views.nodes.nbytes + views.start.nbytes + graph.neighbours.nbytes
    assert 0.3 * 0.2e9 < taken < 0.2e9
    caplog.clear()
    Setup.of(load_scenario("comb-port"))
    assert caplog.messages == []
