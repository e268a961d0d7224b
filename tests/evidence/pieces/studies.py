"""docs/studies.md."""

from collections.abc import Iterator, Sequence

from mjforage.base.atomic_files import write_bytes
from mjforage.runs import communication, sensing
from mjforage.runs.variants import COMPLETE, FAST, IN_TOUCH, PARTS, ROBUST, WRONG, without
from mjforage.view.page.picture import house_style, png_bytes, smaller
from mjforage.view.report.studies import ablation, corruption
from mjforage.view.report.studies import communication as communication_page
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from tests.evidence.piece import REPOSITORY, Cell, Column, Piece, Row, average, defined, interval
from tests.evidence.playing import Runs

_PARTS = "mjforage study parts --seed 1"
_POLICIES = "--policy greedy --policy belief --policy ddqn --episodes 100 --seed 1"
_LINKS = f"mjforage study communication {_POLICIES}"
_EYES = f"mjforage study sensing {_POLICIES}"
_PAPER = "mjforage study paper"
_BELIEF = "mjforage study paper --policy belief --set rules.walls=clip"
_COMPARED = {
    "pta_d": Column("PTA_D %", 2),
    "pta_c": Column("PTA_C %", 2),
    "nt50": Column("NT50", 3),
    "nt90": Column("NT90", 3),
    "csr": Column("CSR", 3),
    "rmse": Column("RMSE", 4),
}
_OF_PARTS = ("pta_c", "nt50", "nt90", "csr", "rmse")
_OF_WORLDS = ("pta_d", "pta_c", "nt50", "nt90", "rmse")
_TITLES = {
    "hotspots": "three hotspots",
    "two-hotspots": "two hotspots",
    "spread": "twice the spread",
    "drift": "twice the drift",
    "calm": "half the drift",
}
_NAMES = {"greedy": "Greedy", "ddqn": "`ddqn`", "belief": "`belief`"}
WORLD = "graph"


def _minus(
    logs: StudyLogs, one: tuple[str, str], other: tuple[str, str], keys: Sequence[str]
) -> Iterator[Cell]:
    """Differences of a variant and policy to another."""
    here, there = Player(one[0], WORLD, one[1]), Player(other[0], WORLD, other[1])
    for key in keys:
        yield interval(logs.values(here, key), logs.values(there, key))


def _parts(runs: Runs) -> Iterator[Row]:
    lines = {without(part): f"without `{part}`" for part in PARTS if part not in IN_TOUCH}
    lines |= {FAST: "`fast`", ROBUST: "`robust`", "greedy": "greedy", "oracle": "*oracle (bound)*"}
    whole = COMPLETE, "belief"
    for policy, head in lines.items():
        yield [head, *_minus(runs.study, (COMPLETE, policy), whole, _OF_PARTS)]


def _wrong(runs: Runs) -> Iterator[Row]:
    for variant in WRONG:
        for policy, head in (("belief", "as it is"), (ROBUST, "`robust`")):
            found = _minus(runs.study, (variant, policy), (variant, "greedy"), _OF_WORLDS)
            yield [_TITLES[variant], head, *found]


def _along(runs: Runs) -> Iterator[Row]:
    """Every variant of a study along axes minus what it is compared with, policy by policy."""
    logs, seen = runs.study, {COMPLETE}
    for axis in communication.AXES if logs.kind == "communication" else sensing.AXES:
        for point in axis.points:
            if point.variant in seen or point.variant == axis.against:
                continue
            seen.add(point.variant)
            head = logs.title(point.variant)
            if axis.against != COMPLETE:
                head += f" (beside: {logs.title(axis.against)})"
            row: list[Cell] = [head]
            for policy in _NAMES:
                one, other = (point.variant, policy), (axis.against, policy)
                row += _minus(logs, one, other, ("pta_c", "nt90"))
            yield row


def _picture(runs: Runs) -> None:
    """PTA_C and NT90 along the axes of the study of communication."""
    pictures = (one for part in communication_page.sections(runs.study) for one in part.pictures)
    chosen = next(one for one in pictures if one.name == f"axes-{WORLD}")
    with house_style():
        picture = smaller(png_bytes(chosen.figure))
        write_bytes(REPOSITORY / "docs/communication.png", picture)


_SLOPES = (("scouts", "pta_c"), ("foragers", "rmse_columns"))
_FLEETS = {"scouts": "1 scout", "foragers": "1 forager"}
PAPER = {
    "SS of PTA_C, scouts": ("−45.14", "−20.86", "−40.55"),
    "SS of RMSE_columns, foragers": (".0104", ".0205", ".0061"),
    "1 scout: PTA_D": ("88.08", "76.17", "93.55"),
    "1 scout: PTA_C": ("82.26", "72.50", "87.92"),
    "1 forager: PTA_D": ("98.70", "78.60", "99.32"),
    "1 forager: PTA_C": ("94.89", "73.85", "95.14"),
    "MC of PTA_C, one scout": (".162", ".099", ".109"),
    "MC of PTA_C, one forager": (".034", ".082", ".036"),
}
"""The paper's Tables 4 to 6: Greedy, Lévy, DRL."""


def _ours(logs: StudyLogs, policy: str) -> dict[str, Cell]:
    """Our numbers of a policy, under the names of the paper's."""
    fits, names = corruption.Fits(logs), iter(PAPER)
    found: dict[str, Cell] = {}
    for team, key in _SLOPES:
        fit = fits.of(team, WORLD, policy, key)
        assert fit is not None
        low, high = fit.intervals.slope
        found[next(names)] = defined(mean=fit.line.slope, low=low, high=high)
    for team in _FLEETS:
        for key in ("pta_d", "pta_c"):
            entry = logs.entry(Player(f"{team}-less", WORLD, policy), key)
            found[next(names)] = defined(mean=entry.mean, low=entry.low, high=entry.high)
    for team in _FLEETS:
        worth = ablation.contribution(logs, team, WORLD, policy, "pta_c")
        found[next(names)] = defined(mean=worth.value, low=worth.low, high=worth.high)
    return found


def _beside_paper(runs: Runs) -> Iterator[Row]:
    ours = {
        policy: _ours(runs.study, policy)
        for policy in ("greedy", "wanderer", "levy", "ddqn-reward")
    }
    for name, (greedy, levy, drl) in PAPER.items():
        row = [greedy, ours["greedy"][name], levy, ours["wanderer"][name], ours["levy"][name]]
        yield [name, *row, drl, ours["ddqn-reward"][name]]


def _belief(runs: Runs) -> Iterator[Row]:
    logs = runs.study
    fits = corruption.Fits(logs)
    for name, cell in _ours(logs, "belief").items():
        yield [name, cell]
    for team, key in _SLOPES:
        fit = fits.of(team, WORLD, "belief", key)
        assert fit is not None
        at = float(fit.bent.break_point)
        low, high = fit.intervals.break_point
        yield [f"break, {team} corrupted [ε]", {"mean": at, "low": low, "high": high}]
    for team in _FLEETS:
        nt90 = logs.values(Player(f"{team}-less", WORLD, "belief"), "nt90")
        yield [f"{_FLEETS[team]}: NT90", average(nt90)]


def _columns(keys: Sequence[str]) -> tuple[Column, ...]:
    return tuple(_COMPARED[key] for key in keys)


_PAIRS = tuple(
    column
    for name in _NAMES.values()
    for column in (Column(f"{name}: PTA_C %", 2), Column("NT90", 3))
)
PIECES = (
    Piece("parts", {"": _PARTS}, (Column(""), *_columns(_OF_PARTS)), _parts),
    Piece(
        "wrong-worlds",
        {"": _PARTS},
        (Column("world"), Column("planner"), *_columns(_OF_WORLDS)),
        _wrong,
        shown=False,
    ),
    Piece(
        "study-communication",
        {"": _LINKS},
        (Column(""), *_PAIRS),
        _along,
        files=("docs/communication.png",),
        write=_picture,
    ),
    Piece("study-sensing", {"": _EYES}, (Column(""), *_PAIRS), _along),
    Piece(
        "beside-paper",
        {"": _PAPER},
        (
            *(Column(""), Column("Greedy, paper"), Column("ours", 4, True)),
            *(Column("Lévy, paper"), Column("`wanderer`", 4, True), Column("`levy`", 4, True)),
            *(Column("DRL, paper"), Column("`ddqn-reward`", 4, True)),
        ),
        _beside_paper,
    ),
    Piece(
        "beside-paper-belief",
        {"": _BELIEF},
        (Column(""), Column("`belief`", 3, True)),
        _belief,
    ),
)
