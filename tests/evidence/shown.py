"""Numbers of pieces as pages show them."""

from mjforage.view.page.table import NOTHING, Number
from mjforage.view.report.cells import mean_cell, needed_digits, number
from tests.evidence.piece import Cell, Column


def shown(cell: Cell, column: Column) -> str:
    """A cell as pages show it."""
    if not isinstance(cell, dict):
        return cell or ""
    digits = int(column.form.strip(".fg"))
    if column.form.endswith("g"):
        return _significant(cell, digits)
    if "low" in cell:
        return _with_interval(cell, digits)
    half = cell.get("half")
    if "gap" not in cell:
        return number(cell.get("mean", float("nan")), digits) + _plus_minus(half, digits)
    few = min(digits, needed_digits(half or 0.0, digits))
    difference = f"{number(cell['gap'], few)}{_plus_minus(half, few)}"
    if difference[0] not in "−–":
        difference = f"+{difference}"
    if cell["gap"] == 0 and not half:
        difference = "0"
    return f"{number(cell['mean'], digits)} ({difference})" if "mean" in cell else difference


def _plus_minus(half: float | None, digits: int) -> str:
    return "" if half is None else f" ± {number(half, digits)}"


def _with_interval(cell: dict[str, float], digits: int) -> str:
    """A difference or mean with its interval; a difference is bold where that leaves out 0."""
    low, high = cell["low"], cell["high"]
    if "gap" not in cell:
        return mean_cell(Number(cell["mean"], low, high), digits, "rough" in cell).text
    digits = needed_digits((high - low) / 2, digits)
    value = number(cell["gap"], digits)
    text = f"{value} ({number(low, digits)} to {number(high, digits)})"
    apart = round(low, digits) > 0 or round(high, digits) < 0
    return f"**{text}**" if apart else text


def _significant(cell: dict[str, float], digits: int) -> str:
    """A mean and its range to so many digits; whole where there are no more before the point."""
    if "mean" not in cell:
        return NOTHING
    value, *ends = (
        f"{one:,.0f}"
        if one == 0 or abs(one) >= 10 ** (digits - 1)
        else f"{one:#.{digits}g}".rstrip(".")
        for one in (cell[key] for key in ("mean", "low", "high") if key in cell)
    )
    text = f"{value} ({' to '.join(ends)})" if ends else value
    return text.replace("-", "−")
