"""Sensitivity slopes of a study whose means at every level are known."""

import numpy as np
import pytest

from mjforage.runs.studies.variants import corrupted_name
from mjforage.view.page.style import policy_colour
from mjforage.view.report.studies import corruption, paper
from mjforage.view.report.studies.study_logs import StudyLogs
from tests.mjforage.view.report.known_data import Means, cells, known_study, told

LEVELS = (0.0, 0.25, 0.5, 0.75, 1.0)
FALLS = {  # team, world, policy -> by how much PTA_C falls and RMSE rises from no level to all
    ("scouts", "graph", "greedy"): (40.0, 0.125),
    ("scouts", "graph", "auction"): (8.0, 0.25),
    ("scouts", "hulls", "greedy"): (60.0, 0.0),
    ("scouts", "hulls", "auction"): (-20.0, 0.5),
    ("foragers", "graph", "greedy"): (-4.0, 0.0625),
    ("foragers", "graph", "auction"): (24.0, 0.75),
    ("foragers", "hulls", "greedy"): (12.0, 1.0),
    ("foragers", "hulls", "auction"): (16.0, -0.25),
}
BENT = (80.0, 80.0, 80.0, 60.0, 40.0)  # CSR is not asked; this is PTA_D of corrupted foragers


def means(team: str, level: float) -> Means:
    found = {}
    for world in ("graph", "hulls"):
        for policy in ("greedy", "auction"):
            fall, rise = FALLS[team, world, policy]
            bent = BENT[LEVELS.index(level)] if team == "foragers" else 80.0
            found[world, policy] = {
                "pta_c": 80.0 - fall * level,
                "rmse": 0.5 + rise * level,
                "pta_d": bent,
                "csr": 0.75,
            }
    return found


@pytest.fixture(scope="module")
def study() -> tuple[StudyLogs, corruption.Fits]:
    variants = {
        corrupted_name(team, level): means(team, level)
        for team in ("scouts", "foragers")
        for level in LEVELS
    }
    logs = known_study(variants, scenario="published", step=0.25, whole_team=True)
    return logs, corruption.Fits(logs)


def signed(value: float, digits: int) -> str:
    """A number as tables have it, by hand."""
    return f"{value:.{digits}f}".replace("-", "−")


def test_what_falls_with_corruption_has_a_falling_slope(
    study: tuple[StudyLogs, corruption.Fits],
) -> None:
    table = corruption.slopes_table(*study)
    ours = [row for row in table.rows if not row.paper]
    found = {(row.group, row.head): row for row in ours}
    for (team, world, policy), (fall, rise) in FALLS.items():
        for label, digits, start, change, way in (
            ("PTA_C", 2, 80.0, -fall, 1),
            ("RMSE", 4, 0.5, rise, -1),
        ):
            row = found[f"{team} corrupted, {label}", f"{policy} · {world}"]
            ends, slope = (
                (signed(x, digits) for x in (start, start + change)),
                signed(change, digits),
            )
            assert row.cells == (*ends, f"{slope} ({slope} to {slope})", *("–",) * 4)
            numbers = [one for one in row.values[:3] if one is not None]
            assert [one.value for one in numbers] == pytest.approx([start, start + change, change])
            assert numbers[2] == pytest.approx((change,) * 3)
            assert (row.group_better, row.colour) == (way, policy_colour(policy))


def test_a_break_has_its_place_and_the_slopes_on_its_sides(
    study: tuple[StudyLogs, corruption.Fits],
) -> None:
    """80 to the half, then 20 less per quarter. By least squares -40: (2 * 40 + 20) / 2.5."""
    found = cells(corruption.slopes_table(*study))
    for world in ("graph", "hulls"):
        assert found["foragers corrupted, PTA_D", f"auction · {world}"] == (
            *("80.00", "40.00", "−40.00 (−40.00 to −40.00)"),
            *("0.50 (0.50 to 0.50)", "0.00", "−80.00", "100"),
        )
        level = found["scouts corrupted, PTA_D", f"auction · {world}"]
        assert level == ("80.00", "80.00", "0.00 (0.00 to 0.00)", *("–",) * 4)


def test_papers_slopes_are_of_their_team_and_metric(
    study: tuple[StudyLogs, corruption.Fits],
) -> None:
    """Its Table 4: -45.14 of PTA_C with corrupted scouts, .0104 of RMSE with foragers."""
    rows = [row for row in corruption.slopes_table(*study).rows if row.paper]
    slopes = {row.group: (row.cells[2], row.group_better) for row in rows}
    assert slopes == {
        "scouts corrupted, PTA_C": ("−45.14", 1),
        "foragers corrupted, RMSE_columns": ("0.0104", -1),
    }
    table = paper.table_4(*study)
    assert table.better == (1, 1, -1)
    assert cells(table) == {
        ("", "greedy · graph"): (told("csr", 0.75), "−40.00 (−40.00 to −40.00)", "–"),
        ("", "greedy · hulls"): (told("csr", 0.75), "−60.00 (−60.00 to −60.00)", "–"),
        ("", "Greedy, paper (its own map)"): ("0.899", "−45.14", "0.0104"),
        ("", "auction · graph"): (told("csr", 0.75), "−8.00 (−8.00 to −8.00)", "–"),
        ("", "auction · hulls"): (told("csr", 0.75), "20.00 (20.00 to 20.00)", "–"),
    }


def test_means_bands_and_lines_are_drawn_over_their_levels(
    study: tuple[StudyLogs, corruption.Fits],
) -> None:
    logs, fits = study
    for team in ("scouts", "foragers"):
        drawn = corruption.picture(logs, fits, team)
        panel = drawn.figure.axes[corruption.KEYS.index("pta_c")]
        assert drawn.figure.axes[-1].get_xlabel() == f"corruption ε of {team}"
        dots = [line for line in panel.lines if line.get_marker() not in ("None", "", "|")]
        found = {(str(one.get_color()), tuple(np.ravel(one.get_ydata()))): one for one in dots}
        wanted = {
            (policy_colour(policy), tuple(80.0 - FALLS[team, world, policy][0] * x for x in LEVELS))
            for world in ("graph", "hulls")
            for policy in ("greedy", "auction")
        }
        assert set(found) == wanted
        assert all(np.ravel(one.get_xdata()).tolist() == list(LEVELS) for one in dots)
        band = np.asarray(panel.collections[0].get_paths()[0].vertices)
        first = band[np.isclose(band[:, 0], 0.0), 1]
        assert (first.min(), first.max()) == pytest.approx((80 - 1.96, 80 + 1.96))
        strokes = [line for line in panel.lines if line.get_marker() == "|"]
        assert not strokes, "a straight line has no break"
    bent = drawn.figure.axes[corruption.KEYS.index("pta_d")]
    marks = [np.asarray(line.get_xydata()) for line in bent.lines if line.get_marker() == "|"]
    assert np.ravel(marks) == pytest.approx([0.5, 80.0] * 4)
