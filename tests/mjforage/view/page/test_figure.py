"""A figure has one layout, whatever it is printed on and in whichever order."""

import re
from collections.abc import Callable

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

from mjforage.view.page.figure import (
    canvas,
    house_style,
    mathtext,
    pdf_bytes,
    png_bytes,
    svg_bytes,
)

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


def test_a_notebook_shows_a_picture() -> None:
    assert canvas(2.0, 1.0)._repr_png_().startswith(b"\x89PNG")


BROKEN = r"$\frac{$"


@pytest.mark.parametrize("form", PRINT)
def test_names_are_no_mathematics(form: Callable[[Figure], bytes]) -> None:
    with house_style():
        figure = canvas(5.6, 3.0)
        axes = figure.subplots()
        axes.plot([1.0, 10.0], label=BROKEN)
        axes.set_xticks([0, 1], [BROKEN, "greedy"])
        axes.set(yscale="log", xlabel=BROKEN, ylabel=f"{mathtext('PTA_C')} [{BROKEN}]")
        axes.set_title(mathtext(f"a_{BROKEN}"))
        axes.text(0.5, 5.0, BROKEN)
        figure.legend()
        figure.suptitle(BROKEN)
    assert form(figure)


def test_our_own_mathematics_stays() -> None:
    with house_style():
        figure = canvas(5.6, 3.0)
        axes = figure.subplots()
        axes.plot([1.0, 1000.0])
        axes.set(yscale="log", xlabel="normalised time  $t/T$", ylabel=mathtext("PTA_C"))
        axes.set_title("policy $5 and $6")
    svg = re.sub("<!--.*?-->", "", svg_bytes(figure, as_text=True).decode(), flags=re.DOTALL)
    assert "$t/T$" not in svg and "mathrm" not in svg and "mathdefault" not in svg
    assert "policy $5 and $6" in svg
    assert axes.xaxis.label.get_parse_math()
