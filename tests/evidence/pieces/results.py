"""docs/evidence/results.md."""

from collections.abc import Callable, Iterator

from tests.evidence.piece import Column, Piece, Row, average, mean
from tests.evidence.pieces import communication, learning, sensing
from tests.evidence.playing import Runs

POLICIES = ("greedy", "levy", "wanderer", "lawnmower", "pso", "random")
_FLAGS = (
    "--policy greedy --policy levy --policy lawnmower --policy wanderer --policy pso"
    " --policy random"
)
BASELINES = f"mjforage evaluate published {_FLAGS} --episodes 100 --jobs 2"
COMB_PORT = f"mjforage evaluate comb-port {_FLAGS} --episodes 100 --jobs 2"
PLANNERS = (
    "mjforage evaluate published --policy belief --policy oracle --policy greedy --episodes 200"
)

PRIMARY = {
    "pta_d": Column("PTA_D %", 1),
    "pta_c": Column("PTA_C %", 1),
    "rmse": Column("RMSE", 4),
    "rmse_columns": Column("RMSE by columns", 4),
    "nt50": Column("NT50", 3),
    "nt90": Column("NT90", 3),
    "throughput": Column("throughput", 3),
    "csr": Column("CSR", 3),
}
COOPERATION = {
    "mi_final": Column("MI at the end", 3),
    "dsl": Column("DSL", 3),
    "itl": Column("ITL", 3),
    "gini_foragers": Column("Gini, foragers", 3),
    "co_scouts": Column("CO, scouts", 3),
    "length": Column("length", 0),
}
PLANNED = {
    "pta_d": Column("PTA_D %", 2),
    "pta_c": Column("PTA_C %", 2),
    "cleared": Column("share of episodes cleared", 2),
    "nt50": Column("NT50", 3),
    "nt90": Column("NT90", 3),
    "csr": Column("CSR", 3),
    "rmse": Column("RMSE", 4),
}

PUBLIC_CODE = (
    (
        *("*Greedy, public code on its own map, 1,300 episodes*", "98.56 ± .40", "97.20 ± .51"),
        *(".0069 ± .0014", ".0018", ".344", ".591", ".243", ".908"),
    ),
    (
        *("*Lévy walked straight (`wanderer`), the same*", "82.02 ± 1.67", "79.08 ± 1.73"),
        *(".0522", ".0168", ".473", ".731", ".197", ".724"),
    ),
    (
        *("*Lévy with its lengths kept (`levy`), 600 episodes*", "82.5 ± 2.4", "80.0 ± 2.5"),
        *("", ".0159", "", "", "", ""),
    ),
)
"""The paper's public code, pooled over seeds; ± half of the 95 % interval."""
PUBLIC_COOPERATION = (
    ("*Greedy, public code, 1,300 episodes*", ".381", ".209", ".189", ".146", ".060", "123.9"),
    ("*Lévy walked straight, the same*", ".444", ".146", ".138", ".196", ".033", "140.7"),
)


def means(
    policies: tuple[str, ...], keys: dict[str, Column], foreign: tuple[Row, ...] = ()
) -> Callable[[Runs], Iterator[Row]]:
    """Rows of policies, columns of metrics, and rows of others' numbers below."""

    def rows(runs: Runs) -> Iterator[Row]:
        for policy in policies:
            yield [policy, *(mean(runs.only.values(policy, key)) for key in keys)]
        yield from foreign

    return rows


def _shared_less(runs: Runs) -> Iterator[Row]:
    """PTA_C where agents do not share one mind, or miss items."""

    def cells(run: str, *policies: str) -> Iterator[dict[str, float] | str | None]:
        for policy in ("greedy", "ddqn", "belief"):
            yield average(runs[run].values(policy, "pta_c")) if policy in policies else None

    everybody = ("greedy", "ddqn", "belief")
    yield ["ideal", *cells("ideal", *everybody), ""]
    yield ["hears 16 nodes far, quays block", *cells("16 nodes, quays block", *everybody), ""]
    taught = average(runs["8 nodes, taught"].values("ddqn-link", "pta_c"))
    yield ["hears 8 nodes far", *cells("8 nodes", *everybody), taught]
    yield [
        "sees half of what is in view, and knows it",
        *cells("half seen", "greedy", "belief"),
        "",
    ]
    radio = "`comb-port-radio`: small radios, eyes that miss; graph"
    yield [radio, *cells("radio", "greedy", "belief"), ""]
    yield ["the same in MuJoCo (50 episodes)", *cells("radio, hulls", "greedy", "belief"), ""]


PIECES = (
    Piece(
        "published",
        {"": BASELINES},
        (Column("policy"), *PRIMARY.values()),
        means(POLICIES, PRIMARY, PUBLIC_CODE),
    ),
    Piece(
        "published-cooperation",
        {"": BASELINES},
        (Column("policy"), *COOPERATION.values()),
        means(("greedy", "levy", "wanderer"), COOPERATION, PUBLIC_COOPERATION),
        shown=False,
    ),
    Piece(
        "published-planners",
        {"": PLANNERS},
        (Column("policy"), *PLANNED.values()),
        means(("belief", "oracle", "greedy"), PLANNED),
    ),
    Piece(
        "radios-and-eyes",
        {
            "ideal": communication.LINKS["ideal"],
            "16 nodes, quays block": communication.LINKS["16 nodes, quays block"],
            "8 nodes": communication.LINKS["8 nodes"],
            "8 nodes, taught": learning.TAUGHT["`comb-port`, 8 nodes"],
            "half seen": sensing.EYES["*p* .5"],
            "radio": sensing.RADIO,
            "radio, hulls": sensing.RADIO_HULLS,
        },
        (Column(""), *(Column(n, 1) for n in ("Greedy", "`ddqn`", "`belief`", "`ddqn-link`"))),
        _shared_less,
    ),
    Piece(
        "comb-port",
        {"": COMB_PORT},
        (Column("policy"), *PRIMARY.values()),
        means(POLICIES, PRIMARY),
    ),
)
