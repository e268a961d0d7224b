"""Moves that follow from vessels: boats of more thrust make more nodes, and clean in less time."""

import copy
import json
import pickle
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mjforage as mf
from mjforage.base.errors import UserError
from mjforage.cli import main
from mjforage.learning.environments.choices import chosen_setup
from mjforage.learning.training.tasks import variants
from mjforage.mission.setup import Setup
from mjforage.physics.run_warnings import run_warnings
from mjforage.physics.vessel_models import vessel_model
from mjforage.physics.vessel_moves import open_setup
from mjforage.physics.vessels import ForceThruster, Vessel, load_vessel
from mjforage.scenario.place import Place
from mjforage.scenario.scenario_file import load_scenario

WORDS = "from vessel"
BOTH = {"scouts": {"moves": WORDS}, "foragers": {"moves": WORDS}}
SET = tuple(f"team.{team}.moves={WORDS}" for team in BOTH)


def boat(newton: float) -> Vessel:
    """An Otter with as much thrust ahead and astern, which has no tuning of its own."""
    sides = ForceThruster(0.5 * newton, 0.5 * newton, 0.0)
    name = f"otter-{newton:g}"
    return replace(load_vessel("otter"), name=name, thruster=sides, control=None, power=None)


def port(newton: float) -> mf.Scenario:
    vessels = {"vessels": {"foragers": boat(newton)}}
    return mf.load_scenario("comb-port", team=BOTH, physics=vessels, period_s=20.0)


def moves(setup: Setup) -> dict[str, int]:
    return {name: role.nodes for name, role in setup.scenario.team.items()}


def test_the_shipped_vessels_make_what_the_shipped_scenarios_say() -> None:
    shipped = mf.load_scenario("comb-port")
    assert mf.load_scenario("comb-port", team=BOTH) == shipped
    assert moves(shipped) == {"scouts": 2, "foragers": 1}


def test_the_number_is_the_most_that_is_made_diagonally_after_a_turn() -> None:
    tuning = vessel_model(load_vessel("ideal")).tuning
    speed, ahead, astern = tuning.cruise_ahead_mps, tuning.acceleration_mps2, tuning.brake_mps2
    ramps_s = speed / ahead + speed / astern  # at half of the speed in the mean
    cruise_s = 30.0 - 0.5 * np.pi / tuning.yaw_rate_radps - ramps_s
    nodes = speed * (0.5 * ramps_s + cruise_s) / (4.0 * np.sqrt(2.0))
    asked = mf.load_scenario("comb-port", team=BOTH, period_s=30.0)
    found = asked.replace(physics={"vessels": {"foragers": "ideal"}})
    assert moves(found)["foragers"] == int(nodes)
    assert not any("late" in line for line in run_warnings(found, ["physics"]))


def test_boats_of_other_thrust_take_another_time_to_clean(tmp_path: Path) -> None:
    """Of few nodes a decision, the stronger one has decisions of a third of the time."""
    weak, strong = port(50), port(500)
    assert moves(weak)["foragers"] == 1 < moves(strong)["foragers"]
    minutes: list[float] = []
    for one in (weak, strong, strong.replace(period_s=6.4)):
        folder = tmp_path / str(len(minutes))
        run = mf.evaluate(one, "greedy", episodes=2, folder=folder)
        info = json.loads((folder / "run.json").read_text())
        assert info["scenario"]["team"]["foragers"]["moves"] == moves(one)["foragers"]
        minutes.append(run.clearing["median_min"].to_list()[0])
    assert minutes[1] != minutes[0] > minutes[2]


def test_what_changes_asks_the_vessel_again() -> None:
    weak = port(50)
    for copied in (weak, copy.deepcopy(weak), pickle.loads(pickle.dumps(weak))):  # noqa: S301
        assert moves(copied.replace(physics={"vessels": {"foragers": boat(500)}})) == moves(
            port(500)
        )
    assert moves(weak.replace(team={"foragers": {"moves": 3}})) == {"scouts": 5, "foragers": 3}
    assert moves(weak.replace(period_s=60.0))["foragers"] > 1
    given = chosen_setup(weak, None, {"period_s": 60})
    assert moves(given) == moves(weak.replace(period_s=60.0))
    slow, quick = variants(weak.asked, {"period_s": (20.0, 60.0)})
    assert [moves(open_setup(one)) for one in (slow, quick)] == [moves(weak), moves(given)]


def test_files_say_it_and_lists_say_what_it_comes_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f'extends = "comb-port"\n[team.foragers]\nmoves = "{WORDS}"\n')
    assert moves(mf.load_scenario(file)) == {"scouts": 2, "foragers": 1}
    with suppress(SystemExit):
        main(["scenarios", str(file)])
    assert capsys.readouterr().out.endswith("# team.foragers.moves = 1, from vessel forager\n")


def test_a_place_has_its_own_pitch() -> None:
    """4 m of the scenario are overruled by its 8 m, of which a scout makes one in 10 s."""
    place = Place(43.0, -20.0, 8.0, 8, 8)
    scenario = load_scenario("open-bay", [SET[0], "map.starts=[]"])
    found = open_setup(scenario, np.ones((8, 8), np.bool_), place=place)
    assert moves(found) == {"scouts": 1, "foragers": 1}


def test_what_is_too_slow_is_refused() -> None:
    with pytest.raises(UserError, match=r"team.foragers.moves = .*a longer period_s or a shorter"):
        port(50).replace(period_s=10.0)
    with pytest.raises(UserError, match=r'moves = "from vesel"; give a number, or "from vessel"'):
        load_scenario("comb-port", ["team.scouts.moves=from vesel"])
    with pytest.raises(UserError, match="no vessel is known here; give a number"):
        Setup.of(load_scenario("comb-port", SET))
