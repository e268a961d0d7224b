"""A figure has one layout, whatever it is printed on and in whichever order."""

from collections.abc import Callable

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

from mjforage.view.page.picture import canvas, house_style, pdf_bytes, png_bytes, svg_bytes

PRINT: tuple[Callable[[Figure], bytes], ...] = (png_bytes, svg_bytes, pdf_bytes)


def drawn() -> Figure:
    """A map's fixed aspect beside curves: what a second layout would move."""
    with house_style():
        figure = canvas(5.6, 3.0)
        left, right = figure.subplots(1, 2)
        left.set(aspect="equal", xlim=(0, 30), ylim=(0, 9), xlabel="column")
        right.plot([0.0, 1500.0], [0.0, 99.25], label="greedy")
        right.set(xlabel="time [s]", ylabel="PTA$_{\\mathrm{C}}$ [%]")
        figure.legend(loc="outside upper left")
    return figure


@pytest.mark.parametrize("asks", [False, True])
def test_the_first_print_lays_out_and_no_other_moves_anything(asks: bool) -> None:
    """Nor does it where a user's settings ask for a layout of every figure."""
    found = []
    for order in (PRINT, PRINT[::-1], PRINT[1:] + PRINT[:1]):
        figure = drawn()
        with mpl.rc_context({"figure.constrained_layout.use": asks}):
            printed = {form.__name__: form(figure) for form in order}
        assert figure.get_layout_engine() is None
        found.append(printed)
    assert found[0] == found[1] == found[2]
