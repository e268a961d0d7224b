"""`mjforage validate`: table, exit code and report folder."""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.validation import Finding, Measure
from mjforage.physics.validation.finding import Line, Panel, at_most
from mjforage.view.validation import write_validation

X = np.linspace(0.0, 1.0, 5)
PANELS = (
    Panel("One", "time (s)", "m", (Line("ours", X, X), Line("law", X, X, expected=True))),
    Panel("Two", "x (m)", "y (m)", (Line("track", X, X**2),), equal=True),
)
GOOD = Finding("good", "1", "A good <one>", "Shows that.", (at_most("x", 0.5, 1.0, "m"),), PANELS)
BAD = Finding("bad", "2", "A bad one", "Shows this.", (Measure("y", math.nan, 0.0, 1.0, "s"),))
NONE = Finding("none", "3", "Not here", "Does not apply.", ())


def test_the_report_is_one_file_with_everything_in_it(tmp_path: Path) -> None:
    page = write_validation([GOOD, BAD, NONE], tmp_path / "v").read_text(encoding="utf-8")
    assert "1 of 2 checks passed, 1 failed; 1 does not apply" in page
    assert "A good &lt;one&gt;" in page and "data:image/png;base64," in page
    assert not re.search(r'(src|href)="(?!#|data:)', page)
    for name in ("good.png", "good.svg"):
        assert (tmp_path / "v" / "figures" / name).stat().st_size > 5_000


def test_the_numbers_are_in_json(tmp_path: Path) -> None:
    write_validation([GOOD, BAD, NONE], tmp_path)
    found = json.loads((tmp_path / "validation.json").read_text(encoding="utf-8"))
    assert found["passed"] is False
    assert found["environment"]["forces"] == "native"
    assert [entry["status"] for entry in found["checks"]] == ["passed", "failed", "does not apply"]
    assert found["checks"][0]["measures"] == [
        {"what": "x", "value": 0.5, "low": None, "high": 1.0, "unit": "m", "passed": True}
    ]
    assert found["checks"][1]["measures"][0]["value"] is None


def test_the_same_findings_give_the_same_bytes(tmp_path: Path) -> None:
    contents = []
    for name in "ab":
        write_validation([GOOD, BAD], tmp_path / name)
        files = sorted(path for path in (tmp_path / name).rglob("*") if path.is_file())
        contents.append([path.read_bytes() for path in files])
    assert len(contents[0]) == 4 and contents[0] == contents[1]


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot be written"):
        write_validation([BAD], tmp_path / "file" / "v")


def test_the_command_prints_a_table_and_writes_the_report(
    command: Callable[..., Any], tmp_path: Path
) -> None:
    done = command(
        "validate", "--out", tmp_path / "v", "--check", "speeds", "--check", "roll-pitch-heave"
    )
    assert done.code == 0, done
    assert re.search(r"3b +speeds +scout, flat out +1\.9\d+ m/s +1\.6 to 2 +passed", done.out)
    assert re.search(r"7 +roll-pitch-heave .* does not apply", done.out)
    assert f"report: {tmp_path / 'v' / 'report.html'}" in done.out
    assert (tmp_path / "v" / "validation.json").is_file()


def test_a_failed_check_is_exit_code_1(
    command: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mjforage.physics.validation.run_checks", lambda *_: [GOOD, BAD])
    done = command("validate", "--out", tmp_path / "v")
    assert done.code == 1
    assert re.search(r"2 +bad +y +nan s +0 to 1 +failed", done.out)
    assert (tmp_path / "v" / "report.html").is_file()


def test_the_folder_is_checked_before_the_checks_run(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(*_: object) -> list[Finding]:
        raise AssertionError("ran")

    monkeypatch.setattr("mjforage.physics.validation.run_checks", run)
    (tmp_path / "file").touch()
    (tmp_path / "full" / "report.html").mkdir(parents=True)
    for name in ("file", "file/v", "file/v/w", "full"):
        said = refused("validate", "--out", tmp_path / name)
        assert f"--out {tmp_path / name}: cannot be written; give a folder" in said
    assert not (tmp_path / "v").exists()


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--check", "zigzg"), "--check zigzg: unknown; did you mean zigzag?"),
        (("--runs", "0"), "--runs 0: give 1 to"),
        (("--chek", "rest"), "--chek"),
    ],
)
def test_bad_words_are_refused(
    refused: Callable[..., str], words: tuple[str, ...], named: str
) -> None:
    assert named in refused("validate", *words)
