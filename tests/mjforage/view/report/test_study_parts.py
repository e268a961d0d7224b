"""Worth of parts of the belief planner, and wrong worlds, in a study with known means."""

import pytest

from mjforage.runs.studies.variants import PARTS, ROBUST, WRONG, without
from mjforage.view.page.table import Table
from mjforage.view.report.sections import Section
from mjforage.view.report.studies import planner_parts
from mjforage.view.report.studies.study_logs import StudyLogs
from tests.mjforage.view.report.known_data import Means, cells, known_study, starred

WORLDS = {"graph": 0.0, "hulls": -16.0}  # what hulls take from every PTA_C
FIRST, SECOND = PARTS[:2]
PTA = {  # variant -> policy -> mean
    "complete": {
        "belief": 80.0,
        without(FIRST): 72.0,
        without(SECOND): 81.0,
        ROBUST: 78.0,
        "greedy": 70.0,
        "oracle": 96.0,
    },
    **{
        name: {"belief": 60.0 + 2 * n, ROBUST: 66.0 + n, "greedy": 52.0, "oracle": 90.0}
        for n, name in enumerate(WRONG)
    },
}


@pytest.fixture(scope="module")
def sections() -> tuple[Section, Section]:
    variants: dict[str, Means] = {
        name: {
            (world, policy): {"pta_c": mean + lost, "nt90": (96.0 - mean) / 64.0}
            for world, lost in WORLDS.items()
            for policy, mean in means.items()
        }
        for name, means in PTA.items()
    }
    logs: StudyLogs = known_study(variants, "parts", bounds=("oracle",))
    parts, wrong = planner_parts.sections(logs)
    return parts, wrong


def table(section: Section, name: str) -> Table:
    (found,) = [one for one in section.tables if one.name == name]
    return found


def column(found: Table, label: str) -> dict[str, str]:
    """Group and head of each row -> its cell there."""
    place = found.columns.index(label)
    return {f"{row.group} {row.head}".strip(): starred(row)[place] for row in found.rows}


def test_parts_are_measured_against_the_whole_planner(sections: tuple[Section, Section]) -> None:
    """Without the first part 8 items of 100 less, without the second one more; hulls take alike."""
    for world in WORLDS:
        found = table(sections[0], f"parts-whole-{world}")
        assert column(found, "PTA_C") == {
            f"without {FIRST}": "*−8.00 (−8.00 to −8.00)*",
            f"without {SECOND}": "*1.00 (1.00 to 1.00)*",
            "robust": "*−2.00 (−2.00 to −2.00)*",
            "greedy": "*−10.00 (−10.00 to −10.00)*",
            "oracle (bound)": "*16.00 (16.00 to 16.00)*",
        }
        assert column(found, "NT_90")[f"without {FIRST}"] == "*0.125 (0.125 to 0.125)*"
        assert found.better == (1, -1)


def test_the_oracle_is_what_is_missed(sections: tuple[Section, Section]) -> None:
    found = column(table(sections[0], "parts-oracle-hulls"), "PTA_C")
    assert list(found) == [
        "whole planner",
        f"without {FIRST}",
        f"without {SECOND}",
        "robust",
        "greedy",
    ]
    assert found["whole planner"] == "*−16.00 (−16.00 to −16.00)*"
    assert found["greedy"] == "*−26.00 (−26.00 to −26.00)*"


def test_means_are_those_of_their_world(sections: tuple[Section, Section]) -> None:
    for world, lost in WORLDS.items():
        found = table(sections[0], f"parts-{world}")
        means = column(found, "PTA_C")
        assert means["whole planner"] == f"{80 + lost:.2f} ± 1.96"
        assert means["oracle (bound)"] == f"{96 + lost:.2f} ± 1.96"
        place = found.columns.index("NT_90")
        assert found.rows[0].also[place] == "6.2 min", "a quarter of 25 minutes"


def test_in_each_wrong_world_the_planner_is_held_against_greedy_there(
    sections: tuple[Section, Section],
) -> None:
    """36 tests of p = 2^-9 make .07: none is bold."""
    found = column(table(sections[1], "wrong-greedy-graph"), "PTA_C")
    assert found["expected world belief"] == "10.00 (10.00 to 10.00)"
    assert found["expected world belief, robust"] == "8.00 (8.00 to 8.00)"
    assert found["expected world oracle (bound)"] == "26.00 (26.00 to 26.00)"
    for n, name in enumerate(WRONG):
        plain, robust = (f"{x:.2f}" for x in (8.0 + 2 * n, 14.0 + n))
        assert found[f"is {name} belief"] == f"{plain} ({plain} to {plain})"
        assert found[f"is {name} belief, robust"] == f"{robust} ({robust} to {robust})"
        assert found[f"is {name} oracle (bound)"] == "38.00 (38.00 to 38.00)"
    means = cells(table(sections[1], "wrong-hulls"))
    assert means[f"is {WRONG[1]}", "belief"][1] == "46.00 ± 1.96"
