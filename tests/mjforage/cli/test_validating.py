"""`mjforage validate`: table and exit code."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mjforage.physics import vessel_checks
from mjforage.physics.vessel_checks import Measure, at_most
from mjforage.scenario.vessel_files import vessel_path


@pytest.mark.parametrize("name", ["forager", "ideal", "otter", "scout"])
def test_shipped_vessels_pass(command: Callable[..., Any], name: str) -> None:
    done = command("validate", name)
    assert done.code == 0, done
    assert re.search(
        r"fast: coasting, off the closed form +\S+ m/s +at most 0.01 +passed", done.out
    )


def test_a_vessel_too_stiff_for_the_time_step_fails(
    command: Callable[..., Any], tmp_path: Path
) -> None:
    text = vessel_path("otter").read_text(encoding="utf-8")
    line = re.search(r"^linear_yaw.*$", text, re.MULTILINE)
    assert line is not None
    stiff = line[0].replace("40.05", "20000.0")
    (tmp_path / "stiff.toml").write_text(text.replace(line[0], stiff), encoding="utf-8")
    done = command("validate", tmp_path / "stiff.toml")
    assert done.code != 0
    assert "unstable" in done.err or "too short for a time step" in done.out


def test_a_failed_check_is_exit_code_1(
    command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    measures = [at_most("good", 0.5, 1.0, "m"), Measure("bad", float("nan"), 0.0, 1.0, "s")]
    monkeypatch.setattr(vessel_checks, "measures_of", lambda vessel: measures)
    done = command("validate", "scout")
    assert done.code == 1
    assert re.search(r"bad +nan s +0 to 1 +failed", done.out)
