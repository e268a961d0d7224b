"""What an agent of each team is worth: the paper's Tables 5 and 6."""

from mjforage.metrics import paired_contribution, paired_p
from mjforage.mission.mission_metrics import describe
from mjforage.runs.variants import COMPLETE, lesser_name
from mjforage.view.page import style
from mjforage.view.page.figure import ReportFigure, house_style
from mjforage.view.page.table import Number, Row, Table
from mjforage.view.report.differences import SEED, Estimate, family_note, set_apart
from mjforage.view.report.published import elsewhere, published_for
from mjforage.view.report.studies.forest import Subject, forest
from mjforage.view.report.studies.study_logs import Player, StudyLogs
from mjforage.view.report.studies.study_page import Section
from mjforage.view.report.text_tables import (
    in_full,
    in_minutes,
    number,
    plus_minus,
    policy_name,
)

IN_PAPER = ("pta_d", "pta_c", "rmse_columns", "rmse")
BEYOND = ("nt50", "nt90", "csr")
KEYS = (*IN_PAPER, *BEYOND)
DIGITS = 3  # of a contribution


def teams(logs: StudyLogs) -> list[str]:
    """Teams of which an agent was left out."""
    return [team for team in logs.base.scenario["team"] if lesser_name(team) in logs.runs]


def contribution(logs: StudyLogs, team: str, world: str, policy: str, key: str) -> Estimate:
    """Marginal Contribution of one agent of a team."""
    full, without = (
        logs.values(Player(variant, world, policy), key)
        for variant in (COMPLETE, lesser_name(team))
    )
    higher = describe(key).better > 0
    found = paired_contribution(full, without, SEED, higher_is_better=higher)
    return Estimate(found, float(paired_p(full, without)), DIGITS)


def setups_table(logs: StudyLogs) -> Table:
    """Return the paper's Table 5: every fleet's performance."""
    rows = []
    metrics = [describe(key) for key in KEYS]
    digits = [metric.digits for metric in metrics]
    for policy in style.ordered(logs.base.policies):
        known = published_for(logs.base, policy)
        for variant in (COMPLETE, *map(lesser_name, teams(logs))):
            group = policy_name(policy, logs.bounds)
            for world in logs.worlds:
                player = Player(variant, world, policy)
                entries = [logs.entry(player, m.key) for m in metrics]
                cells = tuple(map(plus_minus, entries, digits))
                head, colour = logs.title(variant) + logs.suffix(world), style.policy_colour(policy)
                values = tuple(map(in_full, entries))
                timed = zip(entries, metrics, strict=True)
                also = tuple(in_minutes(logs.runs[variant], m, entry) for entry, m in timed)
                rows.append(Row(head, cells, colour, group=group, values=values, also=also))
            if known:
                team = variant.removesuffix(lesser_name(""))
                found = known.printed if variant == COMPLETE else known.ablated[team]
                theirs = [found.get(m.key, float("nan")) for m in metrics]
                cells, values = tuple(map(number, theirs, digits)), tuple(map(Number, theirs))
                rows.append(
                    Row(
                        f"paper{elsewhere(logs.base)}",
                        cells,
                        group=group,
                        paper=True,
                        values=values,
                    )
                )
    notes = ["Mean ± 1.96 SEM."]
    if any(row.paper for row in rows):
        notes.append(
            "The paper's table has the PTA_D and PTA_C columns of its ablated rows exchanged; they "
            "stand right here. RMSE_columns is the number that it printed."
        )
    labels, units = tuple(m.label for m in metrics), tuple(m.unit for m in metrics)
    title = "Every fleet with one agent less (paper's Table 5)"
    better = tuple(m.better for m in metrics)
    words = tuple(notes)
    return Table("table-5", title, labels, tuple(rows), words, units, head="fleet", better=better)


def contributions_table(logs: StudyLogs, name: str, title: str, keys: tuple[str, ...]) -> Table:
    """Marginal Contribution per role and metric."""
    players = [
        (team, policy, world)
        for team in teams(logs)
        for policy in style.ordered(logs.base.policies)
        for world in logs.worlds
    ]
    lines = {
        (team, policy, world): [contribution(logs, team, world, policy, key) for key in keys]
        for team, policy, world in players
    }
    family = [one for line in lines.values() for one in line]
    apart = iter(set_apart(family))
    rows = []
    for team in teams(logs):
        for policy in style.ordered(logs.base.policies):
            for world in logs.worlds:
                found = lines[team, policy, world]
                rows.append(
                    Row(
                        policy_name(policy, logs.bounds) + logs.suffix(world),
                        tuple(one.cell for one in found),
                        style.policy_colour(policy),
                        best=frozenset(i for i in range(len(found)) if next(apart)),
                        group=f"one agent of {team}",
                        values=tuple(one.full for one in found),
                    )
                )
            known = published_for(logs.base, policy)
            if known and set(keys) & set(known.contribution[team]):
                theirs = [known.contribution[team].get(key, float("nan")) for key in keys]
                cells, values = tuple(number(one, 4) for one in theirs), tuple(map(Number, theirs))
                head, group = (
                    f"{known.algorithm}, paper{elsewhere(logs.base)}",
                    f"one agent of {team}",
                )
                rows.append(Row(head, cells, group=group, paper=True, values=values))
    notes = (
        "Share of the performance that an agent brings: (full − without) / full, for costs "
        "(without − full) / without, of the means; in parentheses the bootstrap 95 % interval over "
        f"pairs of the same episodes, of itself alone; {family_note(family)}. Negative: better "
        "without.",
    )
    labels, better = tuple(describe(key).label for key in keys), (1,) * len(keys)
    return Table(name, title, labels, tuple(rows), notes, better=better)


def pictures(logs: StudyLogs) -> list[ReportFigure]:
    """A figure of contributions per world."""
    drawn, looks = [], style.policy_styles(logs.base.policies)
    for world in logs.worlds:
        subjects = [
            Subject(
                f"{policy}, {team}",
                look,
                {key: contribution(logs, team, world, policy, key) for key in KEYS},
                known.contribution[team] if known else {},
            )
            for team in teams(logs)
            for policy, look in looks.items()
            for known in [published_for(logs.base, policy)]
        ]
        metrics = [describe(key) for key in KEYS]
        title = f"Marginal contribution of one agent{logs.suffix(world)}"
        with house_style():
            drawn.append(
                forest(
                    f"contribution-{world}",
                    title,
                    "Share of the performance that one agent of the team brings, a ratio of means.",
                    metrics,
                    subjects,
                    gains=True,
                )
            )
    return drawn


def sections(logs: StudyLogs) -> list[Section]:
    """The page's sections."""
    title = "Marginal contribution of one agent (paper's Table 6)"
    beyond = "Marginal contribution to times and cooperation"
    tables = [
        setups_table(logs),
        contributions_table(logs, "table-6", title, IN_PAPER),
        contributions_table(logs, "contribution-beyond", beyond, BEYOND),
    ]
    return [Section("ablation", "One agent less", "", tables, pictures(logs))]
