"""The report folder: `report.html`, `validation.json`, `figures/*.png|svg`."""

import math
import os
import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from mjforage.base.atomic_files import write_bytes, write_json
from mjforage.base.errors import UserError
from mjforage.physics.callback import install
from mjforage.physics.validation.finding import FAILED, PASSED, Finding, Measure, shown
from mjforage.view.page import Shown, embedded, set_page
from mjforage.view.validation.curves_figure import draw

CHIP_COLOURS = {PASSED: "#009E73", FAILED: "#C2255C"}
REPORT = "report.html"
OTHER_COLOUR = "#9AA5B1"


def check_folder(folder: Path) -> None:
    """Check before the run that the report folder can be written; makes nothing.

    Raises
    ------
    UserError
        If a file is in the way, or a folder may not be written to.
    """
    there = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    writable = there.is_dir() and os.access(there, os.W_OK | os.X_OK)
    if not writable or (folder / REPORT).is_dir():
        raise UserError(f"--out {folder}: cannot be written; give a folder that you may write to")


def write_validation(findings: Sequence[Finding], folder: Path) -> Path:
    """Write the report folder; the same findings give the same bytes.

    Returns
    -------
    Path
        `report.html`.

    Raises
    ------
    UserError
        If a file cannot be written.
    """
    target = folder / REPORT
    figures: dict[str, Shown] = {}
    for finding in findings:
        if finding.panels:
            figures[finding.name] = embedded(draw(finding), folder)
    write_bytes(target, _page(findings, figures).encode("utf-8"))
    write_json(folder / "validation.json", _json(findings))
    return target


def environment() -> dict[str, str]:
    """What the checks ran on: versions, route of the forces, machine."""
    versions = {name: version(name) for name in ("mjforage", "mujoco", "numpy", "numba")}
    here = {"python": platform.python_version(), "machine": platform.machine()}
    return {**versions, **here, "forces": install().value}


def _json(findings: Sequence[Finding]) -> dict[str, Any]:
    return {
        "passed": all(finding.status != FAILED for finding in findings),
        "environment": environment(),
        "checks": [
            {
                "name": finding.name,
                "number": finding.number,
                "title": finding.title,
                "shows": finding.shows,
                "status": finding.status,
                "measures": [_measure(measure) for measure in finding.measures],
            }
            for finding in findings
        ],
    }


def _measure(measure: Measure) -> dict[str, Any]:
    """A measure with null where a number is not finite, which JSON has no word for."""
    numbers = {"value": measure.value, "low": measure.low, "high": measure.high}
    finite = {key: value if math.isfinite(value) else None for key, value in numbers.items()}
    return {"what": measure.what, **finite, "unit": measure.unit, "passed": measure.passed}


def _page(findings: Sequence[Finding], figures: dict[str, Shown]) -> str:
    here, count = environment(), [finding.status for finding in findings].count
    content: dict[str, Any] = {
        "findings": findings,
        "figures": figures,
        "environment": here,
        "passed": count(PASSED),
        "failed": count(FAILED),
        "others": len(findings) - count(PASSED) - count(FAILED),
        "colours": {finding.status: _colour(finding.status) for finding in findings},
        "shown": shown,
    }
    return set_page("validation.html.j2", here["mjforage"], content)


def _colour(status: str) -> str:
    return CHIP_COLOURS.get(status, OTHER_COLOUR)
