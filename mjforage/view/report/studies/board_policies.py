"""Description of each policy of a board: summary, training, weights, page."""

import re
from functools import lru_cache

from mjforage.base.errors import UserError
from mjforage.base.references import parse_reference
from mjforage.graph_planner.policies.registry import (
    check_policy_trusted,
    policy_files,
    policy_names,
    policy_summary,
)
from mjforage.scenario.assets import models_folder
from mjforage.view.page.table import NOTHING, Row, Table
from mjforage.view.report.studies.board_scores import Board

WEIGHTS = "models/weights/README.md"
_PAGE = re.compile(r" \(\[[^\]]+\]\([^)]+\)\)")  # a link in parentheses, true in its folder only
_ROW = re.compile(r"^\| `(?P<file>[^`]+\.safetensors)` \| (?P<cells>.+) \|$", re.MULTILINE)


@lru_cache(maxsize=1)
def training() -> dict[str, str]:
    """Weight file -> its training, from the table in the weights' README.

    Its columns are the file, how it was made, what on, updates and episodes; links are left out.
    """
    path = models_folder() / "weights" / "README.md"
    if not path.is_file():
        return {}
    found = {}
    for row in _ROW.finditer(path.read_text(encoding="utf-8")):
        cells = [cell.strip() for cell in _PAGE.sub("", row["cells"]).split(" | ")]
        if len(cells) == 4:
            how, where, updates, episodes = cells
            found[row["file"]] = f"{how}; on {where}; {updates} updates, {episodes} episodes"
    return found


def page_of(policy: str) -> str:
    """A policy's page in the documentation, from the top of the source; "" without one."""
    name = f"docs/policies/{policy}.md"
    return name if (models_folder().parent / name).is_file() else ""


def given(policy: str) -> tuple[str, str]:
    """Training of a policy, and the page that describes it; "" for an unknown policy."""
    name = parse_reference(policy, "policy").name
    try:
        check_policy_trusted(policy, "study.json")
        files = [path.name for path in policy_files(policy)]
    except UserError:
        files = []
    told = [training().get(file, file) for file in files]
    own = page_of(name)
    shipped = WEIGHTS if any(file in training() for file in files) else ""
    return "; ".join(told), own or shipped


def policies_table(board: Board) -> Table:
    """A row per policy that plays."""
    rows = []
    for policy in board.policies:
        name = parse_reference(policy, "policy").name
        what = policy_summary(name) if name in policy_names() else ""
        trained, page = given(policy)
        cells = (what or NOTHING, trained or NOTHING, f"`{page}`" if page else NOTHING)
        rows.append(Row(board.head(policy), cells, board.colour(policy)))
    columns = ("what it is", "training", "described in")
    return Table("policies", "The policies", columns, tuple(rows), wordy=True)
