"""Numbers and pictures of the tutorials of docs/learning."""

import json
from collections.abc import Iterator
from typing import Any

from mjforage.view.page import style
from mjforage.view.page.figure import canvas, house_style, png_bytes, smaller
from tests.evidence.cells import mean
from tests.evidence.piece import REPOSITORY, Cell
from tests.evidence.playing import Runs

FOLDER = REPOSITORY / "docs" / "learning"
PICTURES = {"twenty_lines": ("twenty_lines",), "fleet": ("fleet",), "hulls": ("graph", "physics")}
NAMES = {
    "twenty_lines": "[twenty lines](twenty_lines.md)",
    "fleet": "[a fleet](fleet.md)",
    "graph": "[on hulls](hulls.md), graph world",
    "physics": "[on hulls](hulls.md), then MuJoCo",
}
SHIPPED = {"ddqn": ("976 episodes", ""), "mappo": ("about 1,400 episodes", "")}
"""Episodes that models/weights/README.md tells; minutes were not kept."""
KEYS = ("return", "pta_c", "nt90")


def scores(runs: Runs) -> Iterator[list[Cell]]:
    """Of each policy return, PTA_C and NT90, and what its training took."""
    trained = runs.figures["trained"]
    for name, values in runs.figures["scores"].items():
        values["nt90"] = [each / 100.0 for each in values["nt90"]]
        cells: list[Cell] = [NAMES.get(name, f"`{name}`"), *(mean(values[key]) for key in KEYS)]
        took: tuple[Cell, Cell] = SHIPPED.get(name, ("", ""))
        if name in trained:
            took = ({"mean": trained[name]["curve"][-1][0]}, {"mean": trained[name]["minutes"]})
        yield [*cells, *took]


def curves(runs: Runs) -> None:
    """Write the learning curves, as data and as a picture of each page."""
    found = {label: one["curve"] for label, one in runs.figures["trained"].items()}
    (FOLDER / "curves.json").write_text(json.dumps(found) + "\n", "utf-8")
    levels = {
        name: float(sum(values["pta_c"]) / len(values["pta_c"]))
        for name, values in runs.figures["scores"].items()
        if name in ("greedy", "random")
    }
    for page, labels in PICTURES.items():
        picture = drawn({label: found[label] for label in labels}, levels)
        (FOLDER / f"{page.replace('_', '-')}.png").write_bytes(picture)


def drawn(curves: dict[str, Any], levels: dict[str, float]) -> bytes:
    """PTA_C [%] of the episodes of training over the decisions, beside levels of other policies."""
    with house_style():
        figure = canvas(5.6, 2.6)
        axes = figure.subplots()
        before = 0.0  # the second training goes on from the first
        for label, colour in zip(curves, style.FALLBACK_COLOURS, strict=False):
            decisions, shares = zip(*curves[label], strict=True)
            name = label if len(curves) > 1 else "training"
            places = [(before + each) / 1000.0 for each in decisions]
            axes.plot(places, shares, color=colour, label=name)
            before += decisions[-1]
        for name, level in levels.items():
            look = style.policy_styles([name])[name]
            axes.axhline(level, color=look.colour, linestyle=":", linewidth=1.0, label=name)
        axes.set(xlabel="decisions of an agent [thousand]", ylabel="PTA_C [%]", ylim=(0.0, 100.0))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        return smaller(png_bytes(figure))
