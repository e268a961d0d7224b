"""Trainings of the tutorials are found on their pages, and their curves in what they leave."""

from pathlib import Path

import pytest

pytest.importorskip("sb3_contrib")

from tests.mjforage.learning.tutorials import PAGES, curve_of, trainings


@pytest.mark.parametrize("page", PAGES)
def test_every_training_is_a_script(page: str) -> None:
    scripts = list(trainings(page))
    assert len(scripts) == len(PAGES[page])
    for script in scripts:
        compile(script, page, "exec")
        assert "DECISIONS = " in script and "mf.compare" not in script


def test_a_curve_is_of_all_monitors_by_time(tmp_path: Path) -> None:
    (tmp_path / "monitor").mkdir()
    head = '#{"t_start": 0}\nr,l,t,pta_c\n'
    (tmp_path / "monitor" / "0.monitor.csv").write_text(f"{head}1,600,1.0,10\n1,400,3.0,30\n")
    (tmp_path / "monitor" / "1.monitor.csv").write_text(f"{head}1,600,2.0,20\n")
    assert curve_of("twenty_lines", tmp_path) == [[600.0, 10.0], [1200.0, 20.0], [1600.0, 30.0]]
