"""Tables as files: numbers in full in CSV, LaTeX and Markdown that read as they are meant."""

import csv
import io
import math

from mjforage.view.page.table import Number, Row, Table
from mjforage.view.page.table_files import csv_text


def read(text: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text)))


def test_csv_holds_numbers_in_full_with_their_intervals() -> None:
    rows = (
        Row("greedy", ("0.3 ± 0.1", "–"), values=(Number(1 / 3, 0.25, 0.5), None)),
        Row('a, "b"', ("1.0", "−2"), values=(Number(1.0), Number(math.nan))),
    )
    table = Table("t", "T", ("PTA_C", "words"), rows, units=("%", ""))
    header, first, second = read(csv_text(table))
    assert header == ["policy", "PTA_C [%]", "PTA_C [%] low", "PTA_C [%] high", "words"]
    assert first[0] == "greedy"
    assert [float(cell) for cell in first[1:4]] == [1 / 3, 0.25, 0.5]
    assert first[4] == ""
    assert second == ['a, "b"', "1", "", "", ""]


def test_csv_of_cells_without_numbers_has_their_words_and_a_plain_minus() -> None:
    table = Table("t", "T", ("a",), (Row("x", ("−1.5",), group="G"), Row("y", ("yes",), group="G")))
    assert read(csv_text(table)) == [
        ["group", "policy", "a"],
        ["G", "x", "-1.5"],
        ["G", "y", "yes"],
    ]


def test_an_interval_in_a_column_of_its_own_becomes_its_two_ends() -> None:
    interval = Number(math.nan, 1.0, 2.5)
    table = Table("t", "T", ("95 % interval",), (Row("x", ("1 to 3",), values=(interval,)),))
    header, row = read(csv_text(table))
    assert header == ["policy", "95 % interval low", "95 % interval high"]
    assert row == ["x", "1", "2.5"]
