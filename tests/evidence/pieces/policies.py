"""docs/policies/ and models/weights/README.md."""

from collections.abc import Iterator, Sequence

from tests.evidence.piece import Cell, Column, Piece, Row, average, beside, gap, mean
from tests.evidence.playing import Runs, flags

HARBOURS = (
    *("combs:1000", "basins:1001", "channels:1002", "islands:1003", "bays:1004"),
    *("combs:1005", "basins:1006", "channels:1007", "islands:1008", "bays:1009"),
)
DISCOUNT = 0.9
FLEETS = (4, 16, 64)
_BY_THE_RULES = "mjforage evaluate comb-port --map"
ELSEWHERE = {
    **{f"`harbour:{harbour}`": f"{_BY_THE_RULES} harbour:{harbour}" for harbour in HARBOURS},
    "`channels`": "mjforage evaluate channels",
}
"""Maps that nothing was trained or tuned on: how a table names them, and how they are played."""


def _decisions(runs: Runs) -> Iterator[Row]:
    """Times as `mjforage bench --decisions` has them, policies as docs/policies/index.md."""
    found: dict[str, list[Cell]] = {}
    for one in runs.figures():
        number = {"mean": one["ms"], "low": one["low"], "high": one["high"]}
        found.setdefault(one["policy"], []).append(one["reason"] or number)
    order = (
        *("belief", "dec-mcts", "ogr", "orienteering", "auction", "ddqn", "ddqn-reward"),
        *("ddqn-link", "mappo", "greedy", "lawnmower", "levy", "wanderer", "pso", "random"),
    )
    for policy in (*order, *sorted(set(found) - set(order))):
        yield [f"`{policy}`", *found[policy]]


def _discounted(harbour: str, discount: float) -> str:
    return (
        f"{_BY_THE_RULES} harbour:{harbour} --policy belief --episodes 100 --seed 7"
        f" --set policy.belief.look_discount={discount:g}"
    )


def _look_discount(runs: Runs) -> Iterator[Row]:
    for harbour in HARBOURS:
        row: list[Cell] = [f"`{harbour}`"]
        for key in ("pta_c", "nt50", "nt90"):
            at_1 = runs[f"{harbour}, 1"].values("belief(look_discount=1)", key)
            less = runs[f"{harbour}, {DISCOUNT}"].values("belief", key)
            row += [average(at_1), gap(less, at_1)]
        yield row


_FAR = {
    "`comb-port`, hears 16 nodes far": "link.range_m=64",
    "`comb-port`, hears 8 nodes far": "link.range_m=32",
}


def _linked(policies: Sequence[str]) -> dict[str, str]:
    """Commands that have policies play over links of a range, by what their rows are called."""
    played = f"mjforage evaluate comb-port {flags(policies)} --episodes 100 --seed 7 --jobs 2"
    return {label: f"{played} --set link.model=disk --set {far}" for label, far in _FAR.items()}


_SHORT = {
    "pta_c": Column("PTA_C %", 2),
    "nt50": Column("NT50", 3),
    "nt90": Column("NT90", 3),
}
LEARNED = {
    "pta_d": Column("PTA_D %", 2),
    **_SHORT,
    "csr": Column("CSR", 3),
    "rmse_columns": Column("RMSE columns", 4),
}


def _blocks(runs: Runs, keys: Sequence[str]) -> Iterator[Row]:
    """Policies of each run below one another, its name beside the first."""
    for label, run in runs.items():
        for number, policy in enumerate(run.info.policies):
            cells = (mean(run.values(policy, key)) for key in keys)
            yield ["" if number else label, policy, *cells]


SETTINGS = {
    "belief": "belief",
    "`explore=0.3`": "dec-mcts(explore=0.3)",
    "`explore=0.1`, the default": "dec-mcts",
    "`explore=0.3`, discounts 0.985": (
        "dec-mcts(explore=0.3, discount=0.985, look_discount=0.985)"
    ),
    "four times the budget, `simulations=192`": "dec-mcts(simulations=192)",
}


def _settings(runs: Runs) -> Iterator[Row]:
    played = dict(zip(SETTINGS, runs.only.info.policies, strict=True))
    for head, policy in played.items():
        yield [head, *(mean(runs.only.values(policy, key)) for key in _SHORT)]


_FOUR = "--policy ddqn --policy ddqn-reward --policy mappo --policy greedy --episodes 1000"
_THREE = "--policy ddqn --policy ddqn-reward --policy greedy --episodes 200 --seed 1"
_MAPPO = "--policy mappo --policy ddqn --policy greedy"
_TAUGHT = "--policy ddqn --policy greedy --episodes 100 --seed 7"


def _other_maps(runs: Runs) -> Iterator[Row]:
    for label, run in runs.items():
        row: list[Cell] = [label]
        for key in LEARNED:
            own, other = (run.values(policy, key) for policy in ("ddqn", "greedy"))
            row.append(beside(own, other))
        yield row


PIECES = (
    Piece(
        "decision-times",
        {"": "mjforage bench --decisions"},
        (Column("policy"), *(Column(f"{fleet} agents", 3, True) for fleet in FLEETS)),
        _decisions,
        minutes=6,
    ),
    Piece(
        "look-discount",
        {
            f"{harbour}, {discount}": _discounted(harbour, discount)
            for harbour in HARBOURS
            for discount in (1, DISCOUNT)
        },
        (
            *(Column("`harbour:`"), Column("PTA_C % at 1", 2), Column("change at 0.9", 2)),
            *(Column("NT50", 3), Column("change", 3), Column("NT90", 3), Column("change", 3)),
        ),
        _look_discount,
    ),
    Piece(
        "auction-links",
        _linked(["auction", "greedy", "belief"]),
        (Column(""), Column("policy"), *_SHORT.values()),
        lambda runs: _blocks(runs, tuple(_SHORT)),
    ),
    Piece(
        "dec-mcts-links",
        _linked(["dec-mcts", "belief"]),
        (Column(""), Column("policy"), *_SHORT.values()),
        lambda runs: _blocks(runs, tuple(_SHORT)),
    ),
    Piece(
        "dec-mcts-settings",
        {"": f"mjforage evaluate comb-port {flags(SETTINGS.values())} --episodes 50 --seed 1"},
        (Column("comb-port, seed 1"), *_SHORT.values()),
        _settings,
    ),
    Piece(
        "mappo",
        {
            "`published`, 200 of seed 7 (map trained on)": "mjforage evaluate published"
            " --policy mappo --policy ddqn --policy ddqn-reward --policy greedy --episodes 200"
            " --seed 7",
            "`published`, 200 of seed 1 (see above)": f"mjforage evaluate published {_MAPPO}"
            " --episodes 200 --seed 1",
            **{
                f"`{name}`, 100": f"mjforage evaluate {words} {_MAPPO} --episodes 100 --seed 1"
                for name, words in (
                    ("open-bay", "open-bay"),
                    ("channels", "channels"),
                    ("harbour:combs:1000", "comb-port --map harbour:combs:1000"),
                    ("harbour:islands:1003", "comb-port --map harbour:islands:1003"),
                )
            },
        },
        (Column("map, episodes"), Column("policy"), *LEARNED.values()),
        lambda runs: _blocks(runs, tuple(LEARNED)),
    ),
    Piece(
        "weights",
        {
            "published (map trained on)": f"mjforage evaluate published {_FOUR} --seed 7",
            "open-bay (not trained on)": f"mjforage evaluate open-bay {_THREE}",
            "channels (not trained on)": f"mjforage evaluate channels {_THREE}",
        },
        (Column("scenario"), Column("policy"), *LEARNED.values()),
        lambda runs: _blocks(runs, tuple(LEARNED)),
    ),
    Piece(
        "weights-harbours",
        {place: f"{played} {_TAUGHT}" for place, played in ELSEWHERE.items()},
        (Column("map"), *LEARNED.values()),
        _other_maps,
    ),
)
