"""Benchmark tasks: one word each, on the right map, by the right rules, in the right world."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.runs.studies.benchmark_tasks import (
    USUAL,
    benchmark_tasks,
    task_of_scenario,
    task_on_map,
)


def test_a_course_is_a_scenario_in_the_graph_world_unless_another_is_named() -> None:
    plain, hulls = (
        task_of_scenario("comb-port", ["horizon=9"]),
        task_of_scenario("comb-port@physics"),
    )
    assert (plain.name, plain.world) == ("comb-port", "graph")
    assert (hulls.name, hulls.world) == ("comb-port@physics", "physics")
    assert (plain.setup.scenario.horizon, hulls.setup.scenario.horizon) == (9, 150)
    assert task_of_scenario("comb-port@graph").name == "comb-port"


def test_a_map_is_played_by_the_rules_of_comb_port_with_starts_of_its_own(tmp_path: Path) -> None:
    file = tmp_path / "our harbour.csv"
    np.savetxt(file, np.ones((9, 9), int), "%d", ",")
    found, known = task_on_map(f"{file}@hulls"), task_of_scenario("comb-port").setup.scenario
    assert found.world == "hulls"
    assert found.name.startswith("comb-port-on-our-harbour.csv")
    assert found.name.endswith("@hulls")
    assert found.setup.grid.navigable.shape == (9, 9)
    assert found.setup.scenario.rules == known.rules
    assert found.setup.start_cells == (), "those of comb-port are of another map"
    asked = task_on_map(str(file), ["map.starts=[[0, 0], [0, 1], [1, 0], [1, 1]]"])
    assert asked.setup.start_cells[:2] == ((0, 0), (0, 1))


def test_maps_come_after_scenarios_and_the_usual_ones_are_played_unless_others_are_named() -> None:
    names = [one.name for one in benchmark_tasks([], ["open_bay"])]
    assert names == [*USUAL, "comb-port-on-open_bay"]
    assert [one.name for one in benchmark_tasks(["channels"], [])] == ["channels"]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: task_of_scenario("comb-port@moon"),
            "course comb-port@moon: no world 'moon' after the @; choose graph",
        ),
        (lambda: task_of_scenario("comb-prt"), "did you mean comb-port?"),
        (lambda: task_on_map("nowhere"), "nowhere"),
        (
            lambda: benchmark_tasks(["channels", "channels@graph"], []),
            "course channels: given twice",
        ),
    ],
)
def test_what_is_no_course_is_named(make: Callable[[], object], words: str) -> None:
    with pytest.raises(UserError, match=words):
        make()
