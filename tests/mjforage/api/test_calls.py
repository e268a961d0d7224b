"""What a call says of itself: its warnings, and what the run folder names as its origin."""

import json
import logging
import random
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mjforage as mf
from mjforage.cli import main

QUIET: dict[str, Any] = {"episodes": 1, "progress": False}


def dice(view: mf.View) -> dict[str, str]:
    """Moves that hang on no seed."""
    return {agent: random.choice(view.legal_moves(agent)) for agent in view.agents}


@pytest.mark.parametrize(("asked", "told"), [("", ""), ("logging.basicConfig(); ", "told\n")])
def test_warnings_are_printed_where_a_user_asks_for_them(asked: str, told: str) -> None:
    code = f"import logging, mjforage; {asked}logging.getLogger('mjforage.runs').warning('told')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert done.stdout == "" and done.stderr.endswith(told) and bool(done.stderr) == bool(told)


def test_a_run_has_the_warnings_of_its_call(bay: mf.Scenario, tmp_path: Path) -> None:
    windy = bay.replace(weather={"gust_intensity": 0.2, "wind_speed_mps": 3.0})
    run = mf.evaluate(windy, "greedy", folder=tmp_path / "run", **QUIET)
    [line] = run.warnings
    assert line.startswith("weather.gust_intensity: not felt in world graph")
    assert repr(run).endswith("seed 0, 1 warning)")
    assert mf.load_run(tmp_path / "run").warnings == ()
    assert mf.evaluate(bay, "greedy", **QUIET).warnings == ()
    study = mf.study("ablation", windy, "greedy", folder=tmp_path / "study", **QUIET)
    assert study.warnings == (line,)


def test_warnings_of_another_thread_are_not_the_runs(bay: mf.Scenario) -> None:
    told: list[int] = []

    def report(done: int, total: int) -> None:
        told.append(done)
        say = logging.getLogger("mjforage.runs").warning
        thread = threading.Thread(target=say, args=("of another call",))
        thread.start()
        thread.join()

    run = mf.evaluate(bay, "greedy", episodes=1, progress=report)
    assert told and run.warnings == ()


def test_what_does_not_come_out_as_logged_is_told_and_not_shown(bay: mf.Scenario) -> None:
    run = mf.evaluate(bay, dice, **QUIET)
    [line] = run.warnings
    assert "episode 0 of dice in world graph does not come out as logged" in line
    with pytest.raises(mf.UserError, match=r"does not come out as logged: .* hang on no seed"):
        run.recording()


def test_a_table_of_a_map_raises_no_question(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    water = np.ones((6, 8), bool)
    water[2:4, 3:5] = False
    mf.load_scenario("open-bay", map=water, horizon=3).to_file(tmp_path / "pond.toml")
    assert mf.load_scenario(tmp_path / "pond.toml").map.water.tolist() == water.tolist()
    assert caplog.messages == []


def test_a_folder_names_the_call_or_the_command_that_made_it(
    bay: mf.Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    bay = mf.load_scenario(bay.to_file("bay.toml"))
    mf.evaluate(bay, "levy", folder="evaluated", **QUIET)
    mf.compare(bay.replace(horizon=2), "levy", folder="compared", **QUIET)
    mf.study("ablation", bay, "levy", folder="study", **QUIET)
    mf.board(["open-bay"], ["levy"], overrides=["horizon=3"], folder="board", **QUIET)
    monkeypatch.setattr(
        "mjforage.view.report.write_report", lambda folder, *_: folder / "report.html"
    )
    command = ["evaluate", "bay.toml", "--policy", "levy", "--episodes", "1", "--out", "commanded"]
    main(command)
    named = {
        str(file.parent): json.loads(file.read_text())["command"]
        for file in (*Path().glob("*/run.json"), *Path().glob("*/study.json"))
    }
    assert named == {
        "evaluated": "made in Python (mjforage.evaluate)",
        "compared": "made in Python (mjforage.compare)",
        "study": "made in Python (mjforage.study)",
        "board": "made in Python (mjforage.board)",
        "commanded": f"mjforage {' '.join(command)}",
    }
    mf.evaluate(bay, "levy", folder="commanded", **QUIET)  # the same run, whoever made it
