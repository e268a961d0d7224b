"""Cells of the report's tables."""

from mjforage.view.report.cells import number_cell


def test_a_number_has_half_of_its_interval_on_either_side() -> None:
    cell = number_cell(5.0, 1, 2.0)
    assert cell.text == "5.0 ± 2.0"
    assert cell.number == (5.0, 3.0, 7.0)
