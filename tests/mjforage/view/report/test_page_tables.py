"""Tables on the page: which way is better, numbers to sort by, CSV beside each, the gap once."""

import base64
import csv
import io
import re
from collections.abc import Callable
from html import unescape
from pathlib import Path

import pytest

from mjforage.view.page.html import environment
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report import write_report
from mjforage.view.report.run_logs import load_logs

pytestmark = pytest.mark.usefixtures("unprinted")
MakeRun = Callable[..., Path]


def html_of(table: Table) -> str:
    source = '{% from "macros.html.j2" import set_table %}{{ set_table(table) }}'
    return environment().from_string(source).render(table=table)


ROWS = (
    Row(
        "a", ("1.2 ± 0.1", "yes", "–"), values=(Number(1.23, 1.1, 1.4), None, Number(float("nan")))
    ),
    Row(
        "paper",
        ("−2", "no", "0 to 1"),
        paper=True,
        values=(Number(-2.0), None, Number(float("nan"), 0.5, 1.0)),
    ),
)
TABLE = Table("t", "Title", ("PTA_C", "words", "span"), ROWS, better=(1, 0, -1))


def test_a_cell_is_sorted_by_its_number_in_full_and_words_by_themselves() -> None:
    cells = re.findall(r"<td([^>]*)>", html_of(TABLE))
    assert [cell.strip() for cell in cells] == [
        'data-value="1.23"',
        "",
        "",
        'data-value="-2"',
        "",
        'data-value="0.5"',
    ]


def test_a_column_says_which_way_is_better_to_eyes_and_ears() -> None:
    head = html_of(TABLE).split("<thead>", 1)[1].split("</thead>", 1)[0]
    _, rising, neither, falling = head.split("<th ")[1:]
    assert "↑" in rising and "higher is better" in rising and 'data-first="descending"' in rising
    assert "↓" in falling and "lower is better" in falling and "data-first" not in falling
    assert "better" not in neither


def test_every_table_of_the_page_has_the_same_csv_in_it_and_in_the_folder(
    make_run: MakeRun,
) -> None:
    folder = make_run(worlds=("graph", "physics"), episodes=2)
    page = write_report(folder).read_text("utf-8")
    links = re.findall(
        r'<a download="([^"]+)" href="data:text/csv;charset=utf-8;base64,([^"]+)"', page
    )
    assert len(links) == len(re.findall(r'<div class="table(?: stacked)?" id=', page)) >= 6
    for name, content in links:
        assert (folder / "tables" / unescape(name)).read_bytes() == base64.b64decode(content)
    text = (folder / "tables" / "headline.csv").read_text("utf-8")
    (first, *_) = csv.DictReader(io.StringIO(text))
    mean = load_logs(folder).summary["graph"]["greedy"]["pta_c"].mean
    assert float(first["PTA_C [%]"]) == mean


@pytest.mark.parametrize(
    ("worlds", "there"), [(("graph",), False), (("physics",), False), (("graph", "physics"), True)]
)
def test_the_reality_gap_is_headed_once_and_only_between_worlds(
    make_run: MakeRun, worlds: tuple[str, ...], there: bool
) -> None:
    page = write_report(make_run(worlds=worlds, episodes=2)).read_text("utf-8")
    assert page.count("The reality gap</h2>") == there
    assert ('href="#gap"' in page) is there
    order = re.findall(r'<section id="([a-z]+)">', page)
    assert order[:2] == ["replay", "result"]
    links = re.findall(r'<a href="#([a-z]+)">', page.split("<nav", 1)[1].split("</nav>", 1)[0])
    assert links == order, "links stand in the order of what they lead to"
    if there:
        assert order.index("figures") < order.index("gap")
        gap = page.split('<section id="gap">', 1)[1].split("</section>", 1)[0]
        assert "<details>" in gap, "so many rows are folded"
