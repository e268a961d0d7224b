"""Contribution of an agent of each team: the paper's Tables 5 and 6."""

from mjforage.metrics import paired_contribution
from mjforage.mission.scoring import describe
from mjforage.runs.studies.variants import COMPLETE, lesser_name
from mjforage.view.page import style
from mjforage.view.page.table import Row, Table
from mjforage.view.report.cells import INTERVAL, metrics_table, printed_row, row, summary_cell
from mjforage.view.report.differences import family_note, judged
from mjforage.view.report.published import elsewhere, published_for
from mjforage.view.report.run_logs import FloatArray, policy_name
from mjforage.view.report.sections import Section
from mjforage.view.report.studies.study_logs import StudyLogs

IN_PAPER = ("pta_d", "pta_c", "rmse_columns", "rmse")
BEYOND = ("nt50", "nt90", "csr")
KEYS = (*IN_PAPER, *BEYOND)
DIGITS = 3  # of a contribution


def teams(logs: StudyLogs) -> list[str]:
    """Teams of which an agent was left out."""
    return [team for team in logs.base.scenario["team"] if lesser_name(team) in logs.runs]


def contribution(
    logs: StudyLogs, team: str, world: str, policy: str, key: str
) -> tuple[FloatArray, int]:
    """Marginal Contribution of one agent of a team, as `paired_contribution`, with its digits."""
    names = COMPLETE, lesser_name(team)
    full, without = (logs.case(name, world, policy).values(key) for name in names)
    higher = describe(key).better > 0
    return paired_contribution(full, without, higher_is_better=higher), DIGITS


def setups_table(logs: StudyLogs) -> Table:
    """Return the paper's Table 5: every fleet's performance."""
    rows: list[Row] = []
    metrics = [describe(key) for key in KEYS]
    for policy in logs.policies:
        known, group = published_for(logs.base, policy), policy_name(policy, logs.bounds)
        for variant in (COMPLETE, *map(lesser_name, teams(logs))):
            for world in logs.worlds:
                case = logs.case(variant, world, policy)
                head = logs.title(variant) + logs.suffix(world)
                cells = [summary_cell(case, metric) for metric in metrics]
                rows.append(row(head, cells, case.look.colour, group=group))
            if known:
                team = variant.removesuffix(lesser_name(""))
                found = known.printed.mean if variant == COMPLETE else known.ablated[team]
                head, about = f"paper{elsewhere(logs.base)}", {"group": group}
                theirs = [(found.get(metric.key), metric.digits) for metric in metrics]
                rows.append(printed_row(head, theirs, **about))
    notes = [f"{INTERVAL}."]
    if any(one.paper for one in rows):
        notes.append(
            "The paper's table has the PTA_D and PTA_C columns of its ablated rows exchanged; they "
            "stand right here. RMSE_columns is the number that it printed."
        )
    title = "Every fleet with one agent less (paper's Table 5)"
    return metrics_table("table-5", title, metrics, rows, notes, head="fleet")


def contributions_table(logs: StudyLogs, name: str, title: str, keys: tuple[str, ...]) -> Table:
    """Marginal Contribution per role and metric."""
    cases = [(t, p, w) for t in teams(logs) for p in logs.policies for w in logs.worlds]
    lines = judged([[contribution(logs, t, w, p, key) for key in keys] for t, p, w in cases])
    cells, rows = iter([[one.cell() for one in line] for line in lines]), []
    for team in teams(logs):
        group = {"group": f"one agent of {team}"}
        for policy in logs.policies:
            head, colour = policy_name(policy, logs.bounds), style.policy_colour(policy)
            rows += [row(head + logs.suffix(w), next(cells), colour, **group) for w in logs.worlds]
            known = published_for(logs.base, policy)
            if known and set(keys) & set(known.contribution[team]):
                theirs = [(known.contribution[team].get(key), 4) for key in keys]
                head = f"{known.algorithm}, paper{elsewhere(logs.base)}"
                rows.append(printed_row(head, theirs, **group))
    note = (
        "Share of the performance that an agent brings: (full − without) / full, for costs "
        "(without − full) / without, of the means; in parentheses the 95 % interval over pairs of "
        "the same episodes; "
        f"{family_note([one for line in lines for one in line])}. Negative: better without."
    )
    about = {"units": (), "better": (1,) * len(keys)}
    return metrics_table(name, title, [describe(key) for key in keys], rows, [note], **about)


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    title = "Marginal contribution of one agent (paper's Table 6)"
    beyond = "Marginal contribution to times and cooperation"
    tables = [
        setups_table(logs),
        contributions_table(logs, "table-6", title, IN_PAPER),
        contributions_table(logs, "contribution-beyond", beyond, BEYOND),
    ]
    return [Section("ablation", "One agent less", "", tables)]
