"""Tables as files: numbers in full in CSV, LaTeX and Markdown that read as they are meant."""

import csv
import io
import math
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from mjforage.view.page.latex_tables import latex_text
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.page.table_files import csv_text, markdown_text, write_table


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


SPECIAL = r"a_b & 100% $x$ {y} \z ~^ #1 <|>[*] -- 名"


def test_latex_compiles_in_parts_whatever_policies_are_called() -> None:
    rows = (
        Row(SPECIAL, ("98.5 ± 1.5", "−0.1 (−0.2 to 0.0)"), best=frozenset({0}), group=SPECIAL),
        Row("Greedy, paper", ("–", "1"), paper=True, group=SPECIAL),
    )
    text = latex_text(
        Table("t", "All of PTA_C", ("PTA_C", "b"), rows, ("with `--flag`",), ("%", ""))
    )
    assert r"\textbf{98.5} {\footnotesize $\pm$ 1.5}" in text
    assert r"$-$0.1 {\footnotesize ($-$0.2 to 0.0)}" in text
    assert r"\textit{Greedy, paper}" in text
    assert r"PTA\textsubscript{C}" in text
    assert r"\texttt{-{}-flag}" in text
    assert "U+540D" in text
    for line in ("\\toprule", "\\midrule", "\\bottomrule", "\\caption{All of"):
        assert text.count(line) == 1
    bare = re.sub(r"\\[&%$#_{}]", "", text)
    assert bare.count("{") == bare.count("}")
    assert "&" not in bare.split("\\begin{tabular}")[0].replace("% needs", "")


@pytest.mark.parametrize("rows", [3, 60])
@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs pdflatex")
def test_latex_compiles(tmp_path: Path, rows: int) -> None:
    lines = [Row(SPECIAL, ("1 ± 2",) * 5, group=str(i // 9), note=SPECIAL) for i in range(rows)]
    table = Table("t", SPECIAL, (SPECIAL,) * 5, tuple(lines), (SPECIAL,), ("%",) * 5)
    write_table(table, tmp_path, ["latex"])
    packages = "[T1]{fontenc}\\usepackage{adjustbox,array,booktabs}"
    whole = f"\\documentclass{{article}}\\usepackage{packages}\\begin{{document}}\\input{{t}}"
    (tmp_path / "all.tex").write_text(whole + "\\end{document}")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, check=False)
    assert done.returncode == 0, done.stdout.decode(errors="replace")[-2000:]


def test_latex_says_which_way_is_better() -> None:
    table = Table("t", "T", ("up", "down", "own"), (Row("x", ("1",) * 3),), better=(1, -1, 0))
    assert r"up $\uparrow$ & down $\downarrow$ & own \\" in latex_text(table)


def test_markdown_has_a_cell_per_column_and_the_best_in_bold() -> None:
    rows = (Row("a|b", ("1 ± 2", "x_y"), best=frozenset({0}), group="*g*"),)
    lines = markdown_text(Table("t", "T", ("PTA_C", "b"), rows, ("`a|b`",), ("%", ""))).splitlines()
    table = [line for line in lines if line.startswith("|")]
    assert [len(re.split(r"(?<!\\)\|", line)) for line in table] == [5] * 4
    assert table[0] == r"| policy | PTA\_C [%] | b |"
    assert table[2] == r"| **\*g\*** |  |  |"
    assert table[3] == r"| a\|b | **1 ± 2** | x\_y |"


def test_a_name_that_no_file_can_have_is_made_one(tmp_path: Path) -> None:
    table = Table("minus-graph-my/policy:P", "T", ("a",), (Row("x", ("1",)),))
    write_table(table, tmp_path, ["csv", "markdown", "latex"])
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".csv", ".md", ".tex"]
