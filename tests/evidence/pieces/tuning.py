"""docs/learning.md: what going on with shipped weights in MuJoCo buys."""

from collections.abc import Iterator

from tests.evidence.piece import Column, Piece, Row, beside, gap
from tests.evidence.pieces.policies import LEARNED
from tests.evidence.pieces.trained import gathered, run_in, together
from tests.evidence.playing import Runs, flags

SEEDS = (1, 2, 3)
WORLDS = ("graph", "physics")
_TUNED = (
    "mjforage train ddqn --scenario comb-port-weather --world {world} --from ddqn --seed {seed}"
    " --updates 1000 --teacher belief --learning teacher_updates=6000"
    " --learning explore_from=0.05 --learning explore_to=0.02 --learning explore_updates=1000"
    " --learning learning_rate=1e-4 --learning gamma=0.95 --learning target_rate=0.01"
    " --learning priority=0 --learning evaluate_every=1000 --learning evaluate_episodes=16"
)
TUNED = {
    f"{world}, seed {seed}": _TUNED.format(world=world, seed=seed)
    for world in WORLDS
    for seed in SEEDS
}
PLAYED = {
    "`comb-port-weather`, MuJoCo": "comb-port-weather --world physics",
    "`comb-port-weather`, graph": "comb-port-weather",
}


def _tuned(runs: Runs) -> Iterator[Row]:
    """Of each world of training the mean of its seeds' last weights, episode by episode."""
    home = next(iter(runs.folders.values())).with_name("tuned-in-physics")
    last = {
        world: gathered((runs.folders[f"{world}, seed {seed}"] for seed in SEEDS), home)
        for world in WORLDS
    }
    policies = flags(["ddqn", *last["graph"], *last["physics"]])
    for place, played in PLAYED.items():
        run = run_in(home, f"mjforage evaluate {played} {policies} --episodes 100 --seed 7")
        before = {key: run.values("ddqn", key) for key in LEARNED}
        after = {
            world: {key: together(run, names, key) for key in LEARNED}
            for world, names in last.items()
        }
        for world in WORLDS:
            went_on = "MuJoCo" if world == "physics" else "the graph world"
            cells = [beside(after[world][key], before[key]) for key in LEARNED]
            yield [place if world == "graph" else "", f"in {went_on}", *cells]
        differences = [gap(after["physics"][key], after["graph"][key]) for key in LEARNED]
        yield ["", "MuJoCo − graph", *differences]


PIECES = (
    Piece(
        "tuned-in-physics",
        TUNED,
        (Column("played on"), Column("went on"), *LEARNED.values()),
        _tuned,
        minutes=50,
    ),
)
