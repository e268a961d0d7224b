"""A study's numbers beside the paper's: judged only where they are the same quantity."""

import re
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from mjforage.mission.setup import Setup
from mjforage.runs.studies import variants
from mjforage.runs.studies.study import Study, run_study
from mjforage.runs.studies.variants import corrupted_name
from mjforage.scenario.scenario_file import load_scenario
from mjforage.view.page.html import environment
from mjforage.view.page.table import NOTHING, Number
from mjforage.view.report.studies import (
    ablation,
    corruption,
    numbered,
    paper,
    write_study_report,
)
from mjforage.view.report.studies.study_logs import StudyLogs, load_study
from mjforage.view.report.studies.study_page import opening_sections
from tests.mjforage.view.report.known_data import Means, cells, known_study

pytestmark = pytest.mark.usefixtures("unprinted")
Make = Callable[..., StudyLogs]
STEP = 0.25
WORDS = "paper: one draw for the team; ours: one per agent"


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Make:
    """Make a small study of the paper, with one draw for the team or one per agent.

    A second call returns the same study, which nobody may change.
    """

    @cache
    def make(whole_team: bool, overrides: tuple[str, ...] = ()) -> StudyLogs:
        setup = Setup.of(load_scenario("published", overrides))
        varied = variants.paper(setup.scenario, ["greedy"], STEP, whole_team)
        options = {"step": STEP, "whole_team": whole_team}
        folder = tmp_path_factory.mktemp("studies") / "paper"
        run_study(Study("paper", setup, varied, episodes=2, options=options), folder)
        return load_study(folder)

    return make


def _with_fits(logs: StudyLogs) -> tuple[StudyLogs, corruption.Fits]:
    return logs, corruption.Fits(logs)


def test_our_numbers_stand_beside_the_papers_with_their_difference() -> None:
    """Greedy of its public code: PTA_D 98.56 ± .40, PTA_C 97.20 ± .51, NT90 .591, CSR .908.

    Without a scout it collects 82.26 %, whose contribution is .1623; SS of PTA_C is -45.14.
    """
    shift = {"graph": 0.0, "hulls": -8.0}

    def means(pta_c: float, part: float = 1.0) -> Means:
        other = {"nt90": 0.591, "csr": 0.875}
        return {
            (world, "greedy"): {"pta_c": [pta_c + part * by] * 10, "pta_d": [98.0] * 10, **other}
            for world, by in shift.items()
        }

    variants = {"complete": means(97.5), "scouts-less": means(78.0)}
    for level in (0.25, 0.5, 0.75, 1.0):
        variants[corrupted_name("scouts", level)] = means(97.5 - 44.0 * level, 1 - level)
        variants[corrupted_name("foragers", level)] = means(97.5)
    logs = known_study(variants, scenario="published", step=0.25, whole_team=True)
    table = paper.beside_table(logs, corruption.Fits(logs))
    found = cells(table)
    here, hulls = (f"greedy · {world}, beside the paper's Greedy (graph)" for world in shift)
    expected = {
        "PTA_D": ("Table 2", "98.56 ± 0.40", "98.00", "72.63 to 98.52", "−0.56", "yes"),
        "PTA_C": ("Table 2", "97.20 ± 0.51", "97.50", "72.26 to 98.15", "0.30", "yes"),
        "CSR": ("Table 4", "0.908", "0.875", "0.648 to 0.907", "−0.033", "no"),
        "PTA_C, is scouts-less": ("Table 5", "82.26", "78.00", "57.81 to 83.70", "−4.26", "yes"),
        "MC of PTA_C, one of scouts": (
            *("Table 6", "0.1623", "0.2000", "0.2000 to 0.2000", "0.0377", "no"),
        ),
        "SS of PTA_C, scouts corrupted": (
            *("Table 4", "−45.14", "−44.00", "−44.00 to −44.00", "1.14", "no"),
        ),
    }
    for head, row in expected.items():
        assert found[here, head] == row, head
    assert found[hulls, "PTA_C"][2:] == ("89.50", "66.33 to 92.22", "−7.70", NOTHING)
    share = (89.5 - 70) / 89.5
    assert found[hulls, "MC of PTA_C, one of scouts"][2] == f"{share:.4f}"
    assert found[hulls, "SS of PTA_C, scouts corrupted"][2] == "−36.00", "8 less at no level"
    assert found[here, "RMSE"] == ("–", "0.0069", *("–",) * 4), "ours are not defined"
    (full,) = [row for row in table.rows if (row.group, row.head) == (here, "PTA_C")]
    theirs, ours, apart = full.number(1), full.number(2), full.number(4)
    assert theirs == pytest.approx((97.2, 96.69, 97.71))
    assert ours is not None and apart is not None
    assert [ours.value, apart.value] == pytest.approx([97.5, 0.3])

    other = known_study(variants, scenario="published", step=0.25, whole_team=False)
    table = paper.beside_table(other, corruption.Fits(other))
    slopes = [row for row in table.rows if row.head.startswith("SS of")]
    assert len(slopes) == 2 and {(row.cells[-1], row.note) for row in slopes} == {(NOTHING, WORDS)}


def test_another_fleet_has_no_words_on_the_papers_rows(study: Make) -> None:
    logs = study(False, ("team.scouts.count=3",))
    fits = corruption.Fits(logs)
    tables = (
        ablation.setups_table(logs),
        corruption.slopes_table(logs, fits),
        paper.table_4(logs, fits),
    )
    assert paper.sections(logs)[0].words == paper.UNLIKE, "what is missing is not silently so"
    assert paper.sections(study(False))[0].words == ""
    for table in tables:
        assert not any(row.paper for row in table.rows)
        said = " ".join((*table.notes, *table.units))
        for words in ("printed", "stand right here", WORDS):
            assert words not in said, table.name
    assert "printed slopes" in " ".join(corruption.slopes_table(*_with_fits(study(False))).notes)


def test_hulls_are_not_judged_against_the_papers_world() -> None:
    ours = Number(98.0, 97.0, 99.0)
    asked, other = (paper.Beside("PTA_C", 98.2, ours, 2, like) for like in (True, False))
    assert (asked.cells[-1].text, other.cells[-1].text) == ("yes", NOTHING)
    assert [paper.same_world(world) for world in ("graph", "hulls", "physics")] == [
        True,
        False,
        False,
    ]


@pytest.mark.parametrize(("place", "cut"), [(1, {"before"}), (10, set()), (19, {"after"})])
def test_one_level_beside_a_break_has_no_slope(place: int, cut: set[str]) -> None:
    levels = np.linspace(0.0, 1.0, 21)
    means = 90 - 40 * levels - 20 * np.maximum(0.0, levels - levels[place])
    values = np.repeat(means[:, None], 12, axis=1)
    values += np.random.default_rng(0).normal(0.0, 1e-6, values.shape)
    found = corruption.fit_cells(corruption.fit_levels(levels, values), 1)
    cells = {name: one.text for name, one in zip(corruption.COLUMNS, found, strict=True)}
    slopes = {"before": "−40.0", "after": "−60.0"}
    assert {side: cells[side] for side in slopes} == {
        side: NOTHING if side in cut else slope for side, slope in slopes.items()
    }


def test_titles_name_the_papers_tables_and_figures(study: Make) -> None:
    sections = [*opening_sections(study(True)), *paper.sections(study(True))]
    sections = list(map(numbered, sections))
    titles = {one.name: one.title for s in sections for one in s.tables}
    titles |= {one.name: one.title for s in sections for one in s.pictures}
    expected = {
        **{f"table-{n}": f"Table {n}" for n in (4, 5, 6)},
        "scenario": "Figure 2",
        "pta": "Figure 4",
        "rmse": "Figure 5",
        "idleness": "Figure 6",
        "dsl": "Figure 7",
        "itl": "Figure 8",
        "csr": "Figure 9",
        "corruption-scouts": "Figure 10",
        "corruption-foragers": "Figure 11",
        "gini": "Figure 12",
        "overlap": "Figure 13",
    }
    for name, number in expected.items():
        assert f"(paper's {number})" in titles[name], name
    assert "paper's" not in titles["slopes"]


def test_nothing_on_a_page_has_the_anchor_or_the_label_of_another(study: Make) -> None:
    page = write_study_report(study(True).folder).read_text(encoding="utf-8")
    for pattern in (r'\bid="([^"]+)"', r'role="region"[^>]* aria-label="([^"]+)"'):
        found = re.findall(pattern, page)
        assert len(found) == len(set(found)) > 10, pattern


def test_labels_that_come_again_are_numbered_on_each_page_anew() -> None:
    for _ in range(2):
        page = environment().from_string(
            "{{ distinct('Means') }}|{{ distinct('Means') }}|{{ distinct('Other') }}"
        )
        assert page.render() == "Means|Means (2)|Other"
