"""docs/concepts/worlds.md, README.md and docs/physics-mission.md: what hulls and items cost."""

from collections.abc import Iterator

import polars as pl

from mjforage.runs.parquet import read_parquet
from tests.evidence.piece import Cell, Column, Piece, Row, gap, mean
from tests.evidence.playing import Run, Runs

CALM = (
    "mjforage compare comb-port --ladder --policy greedy --policy levy --policy belief"
    " --policy oracle --episodes 50 --jobs 2"
)
WEATHER = (
    "mjforage compare comb-port-weather --ladder --policy greedy --policy belief --episodes 50"
    " --seed 5 --jobs 2"
)
NAMES = {"belief": "**belief**", "oracle": "*oracle (bound)*"}
LADDER = {
    "pta_d": Column("PTA_D %", 1),
    "pta_c": Column("PTA_C %", 1),
    "nt50": Column("NT50", 3),
    "nt90": Column("NT90", 3),
    "csr": Column("CSR", 3),
}


def _ladder(runs: Runs) -> Iterator[Row]:
    """The graph's means, and what each world differs from it on the same episodes."""
    run = runs.only
    for policy in run.info.policies:
        for world in run.info.worlds:
            if world == "graph":
                head = [NAMES.get(policy, policy), world]
                yield [*head, *(mean(run.values(policy, key, world)) for key in LADDER)]
            else:
                yield ["", f"{world} − graph", *(_gap(run, policy, key, world) for key in LADDER)]


def _gap(run: Run, policy: str, key: str, world: str) -> Cell:
    return gap(run.values(policy, key, world), run.values(policy, key, "graph"))


def _brief(runs: Runs) -> Iterator[Row]:
    run = runs.only
    for policy in run.info.policies:
        row: list[Cell] = [NAMES.get(policy, policy)]
        for key in ("pta_c", "nt90"):
            row += [mean(run.values(policy, key, "graph")), _gap(run, policy, key, "physics")]
        yield row


def _on_hulls(scenario: str, policy: str, episodes: int, seed: int, more: str = "") -> str:
    return (
        f"mjforage compare {scenario} --policy {policy} --episodes {episodes} --seed {seed}{more}"
    )


_ROOM = " --set team.scouts.count={0} --set team.foragers.count={0}"
HULLS = {
    **{
        f"{words}, seed {seed}": _on_hulls("comb-port-weather", "belief", 100, seed, flag)
        for words, flag in (
            ("`comb-port-weather`", ""),
            ("places known", " --set sensors.pickup_noise_m=0"),
            ("0.3 m/s of current", " --set weather.current_speed_mps=0.3"),
        )
        for seed in (5, 9)
    },
    "8 vessels, 200 episodes": _on_hulls("comb-port-weather", "belief", 200, 11, _ROOM.format(4)),
    "16 vessels, 50 episodes": _on_hulls("comb-port-weather", "belief", 50, 11, _ROOM.format(8)),
    "`comb-port-wind-5`, 50 episodes": _on_hulls("comb-port-wind-5", "belief", 50, 5),
    "`comb-port-wind-8`, 50 episodes": _on_hulls("comb-port-wind-8", "belief", 50, 5),
}


def _hulls(runs: Runs) -> Iterator[Row]:
    for label, run in runs.items():
        row: list[Cell] = [label]
        for key in ("pta_c", "nt50", "nt90"):
            row += [mean(run.values("belief", key, "physics")), _gap(run, "belief", key, "physics")]
        yield [*row, {"mean": _fastest_touch(run)}]


def _fastest_touch(run: Run) -> float:
    """Fastest approach to a touch of a quay or hull [m/s]."""
    keys = ("world", "policy", "episode", "impact_mps")
    rows = read_parquet(run.folder / "agents.parquet", keys, pl.col("world") == "physics")
    return float(rows["impact_mps"].max())  # type: ignore[arg-type]


_HULL_COLUMNS = (
    Column("`belief` in MuJoCo"),
    *(
        column
        for head, digits in (("PTA_C %", 2), ("NT50", 3), ("NT90", 3))
        for column in (Column(head, digits), Column("minus graph", digits))
    ),
    Column("fastest touch [m/s]", 3),
)


_GROUND = {
    "open_water": "the next node, open water",
    "straight_quay": "straight quay, from the node or one beside it",
    "corner_from_within": "corner, from the node",
    "corner_from_beside": "corner, from a node beside it",
}


def _picking(runs: Runs) -> Iterator[Row]:
    """Shares taken within each decision, for each way of seeing the item, place by place."""
    told = runs.figures()
    for place, words in _GROUND.items():
        shares = [share for one in told if one["place"] == place for share in one["shares"]]
        yield [words, *({"mean": share} for share in shares)]


def _piece(name: str, command: str) -> Piece:
    columns = Column("policy"), Column("world"), *LADDER.values()
    return Piece(name, {"": command}, columns, _ladder)


PIECES = (
    _piece("gap", CALM),
    Piece(
        "gap-brief",
        {"": CALM},
        (
            *(Column("policy"), Column("PTA_C %, graph", 1), Column("physics − graph", 1)),
            *(Column("NT90, graph", 3), Column("physics − graph", 3)),
        ),
        _brief,
    ),
    _piece("gap-weather", WEATHER),
    Piece("hulls", HULLS, _HULL_COLUMNS, _hulls),
    Piece(
        "picking",
        {"": "python -m tests.controllers.picking_ground"},
        (
            Column("where"),
            *(
                Column(f"{seen}, {within} s", 2)
                for seen in ("known", "0.1 m", "0.2 m")
                for within in (10, 20, 30)
            ),
        ),
        _picking,
        minutes=1,
    ),
)
