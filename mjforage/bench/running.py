"""`mjforage bench`: speeds on this machine, in CPU seconds of one core, compile time excluded.

Machines are noisy: compare figures of one run with each other, and runs by their ratios.
"""

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from mjforage.bench.learning import learning_speeds
from mjforage.bench.memory import peak_memory_mb
from mjforage.bench.missions import mission_speeds
from mjforage.bench.rates import Rate, rate
from mjforage.bench.simulations import physics_speeds
from mjforage.graph_planner.policies import create_policy
from mjforage.mission.mission import Mission
from mjforage.mission.mission_metrics import Scorer
from mjforage.mission.setup import Setup
from mjforage.runs.evaluate import evaluate
from mjforage.scenario.maps import GridMap
from mjforage.scenario.scenario_file import load_scenario

Figures = dict[str, dict[str, float | str]]
Progress = Callable[[str], None]

BATCH = 400  # episodes
POLICIES = ("random", "greedy", "levy", "lawnmower", "wanderer", "pso")
DECISIONS = "decisions of the whole fleet per CPU second of one core, full setting"
STEPS = "environment steps per CPU second of one core"
LARGE = (
    *("team.scouts.count=32", "team.foragers.count=32", "items.mean=5000", "items.std=0"),
    *("items.covariance_node2=1e5", "map.starts=[]"),
)
LARGE_SHAPE = (1000, 1000)
LARGE_STEPS = 20
BELIEF_BATCH = 20  # episodes
BELIEF_FLEETS = (4, 8, 16)  # agents, half of them scouts
BELIEF_HORIZON = 60  # decisions of those
LINK = ("link.model=disk", "link.range_m=64")
MISSES = ("sensors.detection=0.9", "belief.detection=0.9")
PHYSICS_S = 120.0  # simulated time of a slice
PHYSICS_BATCH = 4  # simulations
MISSION = (10, 150)  # episodes and decisions of a mission in MuJoCo


def _figure(found: float | Rate, unit: str) -> dict[str, float | str]:
    if isinstance(found, Rate):
        return {"value": found.median, "quickest": found.quickest, "unit": unit}
    return {"value": found, "unit": unit}


def _steps(setup: Setup, policy_name: str, episodes: int) -> Callable[[], float]:
    mission, policy = Mission(setup), create_policy(policy_name)

    def work() -> float:
        mission.reset(0, np.arange(episodes))
        mission.run(policy)
        return float(mission.step.sum())

    return work


def _evaluated_steps(
    episodes: int, world: str = "graph", horizon: int = 150, overrides: tuple[str, ...] = ()
) -> float:
    """Steps of an evaluation of Greedy on the default scenario, logs and summary included."""
    setup = Setup.of(load_scenario("comb-port", (f"horizon={horizon}", *overrides)))
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run"
        summary = evaluate(setup, ["greedy"], run, worlds=[world], episodes=episodes)
    return float(summary[world]["greedy"]["length"]["mean"]) * episodes


def _scoring(setup: Setup, episodes: int) -> Callable[[], float]:
    mission = Mission(setup)
    mission.reset(0, np.arange(episodes))
    scorer = Scorer(mission)
    mission.run(create_policy("greedy"), (scorer,))

    def work() -> float:
        scorer.scores()
        return float(episodes)

    return work


def _large_setup(shape: tuple[int, int]) -> Setup:
    """64 agents and 5,000 items in a large harbour of basins behind long moles."""
    navigable = np.ones(shape, np.bool_)
    navigable[::40, : shape[1] - 30] = False
    navigable[20::40, 30:] = False
    return Setup(load_scenario("comb-port", LARGE), GridMap("large", navigable))


def _large_work(
    policy_name: str, shape: tuple[int, int], steps: int
) -> tuple[Callable[[], float], Callable[[], None]]:
    """Some first steps in the large harbour, and what begins them anew."""
    setup = _large_setup(shape)
    mission, policy = Mission(setup), create_policy(policy_name)

    def work() -> float:
        for _ in range(steps):
            mission.advance(policy.act(mission.observation))
        return float(steps)

    def begin() -> None:
        mission.reset(0, np.arange(1))
        policy.reset(setup.task, mission.keys)

    return work, begin


def _go_large(shape: tuple[int, int], steps: int) -> float:
    """Greedy in the large harbour, for its memory."""
    work, begin = _large_work("greedy", shape, steps)
    begin()
    return work()


def _belief_setup(agents: int, overrides: tuple[str, ...] = ()) -> Setup:
    """The default mission with so many agents, cut where most of the work is done."""
    half = agents // 2
    teams = (f"team.scouts.count={half}", f"team.foragers.count={agents - half}")
    return Setup.of(load_scenario("comb-port", (*teams, f"horizon={BELIEF_HORIZON}", *overrides)))


def _belief_speeds(measure: Callable[[str, str, Callable[[], float]], None]) -> None:
    """The belief planner: speed of both settings, and what a decision of a fleet costs."""
    for name, fast in (("belief", False), ("belief_fast", True)):
        setup = Setup.of(load_scenario("comb-port", (f"belief.fast={str(fast).lower()}",)))
        measure(f"graph_{name}_steps_per_core_s", STEPS, _steps(setup, "belief", BELIEF_BATCH))
    for agents in BELIEF_FLEETS:
        steps = _steps(_belief_setup(agents), "belief", BELIEF_BATCH // 2)
        measure(f"belief_decisions_{agents}_agents_per_core_s", DECISIONS, steps)


def _information_speeds(measure: Callable[[str, str, Callable[[], float]], None]) -> None:
    """Where every agent acts by what it knows itself, and where looks miss items."""
    for name, overrides in (("link", LINK), ("misses", MISSES)):
        setup = Setup.of(load_scenario("comb-port", overrides))
        measure(f"graph_greedy_{name}_steps_per_core_s", STEPS, _steps(setup, "greedy", BATCH))
        few = _steps(setup, "belief", BELIEF_BATCH // 2)
        measure(f"graph_belief_{name}_steps_per_core_s", STEPS, few)
    whole = partial(_evaluated_steps, BATCH, overrides=LINK)
    measure("evaluate_greedy_link_steps_per_core_s", STEPS, whole)
    most = BELIEF_FLEETS[-1]
    for policy, episodes in (("greedy", 2 * BELIEF_BATCH), ("belief", 2)):
        steps = _steps(_belief_setup(most, LINK), policy, episodes)
        measure(f"{policy}_decisions_{most}_holders_per_core_s", DECISIONS, steps)


def bench(progress: Progress = lambda name: None) -> Figures:
    """Measure everything: key -> {"value", "unit"}.

    A value that is a speed is the median of slices, and has the "quickest" of them beside it.

    Parameters
    ----------
    progress : called with the key that is about to be measured
    """
    setup = Setup.of(load_scenario("comb-port"))
    figures: Figures = {}

    def measure(key: str, unit: str, work: Callable[[], float]) -> None:
        progress(key)
        figures[key] = _figure(rate(work), unit)

    for name in POLICIES:
        measure(f"graph_{name}_steps_per_core_s", STEPS, _steps(setup, name, BATCH))
    _belief_speeds(measure)
    _information_speeds(measure)
    whole = partial(_evaluated_steps, BATCH)
    measure("evaluate_greedy_steps_per_core_s", STEPS, whole)
    measure("metrics_episodes_per_s", "episodes per CPU second", _scoring(setup, BATCH))
    large = (LARGE_SHAPE, LARGE_STEPS)
    for name in ("random", "greedy"):
        progress(key := f"graph_large_{name}_steps_per_core_s")
        figures[key] = _figure(rate(*_large_work(name, *large)), STEPS)
    progress("physics")
    speeds = physics_speeds(PHYSICS_S, PHYSICS_BATCH) | mission_speeds(*MISSION)
    for key, value in speeds.items():
        figures[key] = _figure(value, _physics_unit(key))
    progress("learning")
    for key, value in learning_speeds().items():
        figures[key] = _figure(value, _learning_unit(key))
    progress("memory")
    for key, value in _memories(large).items():
        figures[key] = _figure(value, "MB, peak of a process that does only this")
    return figures


def _memories(large: tuple[tuple[int, int], int]) -> dict[str, float]:
    """Peak memory [MB] of evaluations in both worlds and of the large harbour."""
    episodes, horizon = MISSION
    return {
        "peak_memory": peak_memory_mb(partial(_evaluated_steps, BATCH)),
        "peak_memory_large": peak_memory_mb(partial(_go_large, *large)),
        "peak_memory_physics": peak_memory_mb(
            partial(_evaluated_steps, episodes, "physics", horizon)
        ),
    }


def _learning_unit(key: str) -> str:
    if "obs_steps" in key:
        return "agent observations per CPU second of one core, environment included"
    if "frames" in key:
        return "pictures of an environment from above, 640 pixels wide, per CPU second of one core"
    if "env_steps" in key:
        return "environment steps per CPU second of one core, observations included"
    if "updates" in key:
        return "updates of one team's network per CPU second of one core"
    return "of the time of training"


def _physics_unit(key: str) -> str:
    if "mission" in key:
        return "simulated seconds per CPU second of one core, a logged mission of Greedy"
    if "core_min" in key:
        return "CPU minutes of one core for 100 episodes of 1500 s"
    if "share" in key:
        return "of the time of that mission"
    if "sim_s" in key:
        return "simulated seconds per CPU second of one core (4 vessels, 75 items)"
    if "steps" in key:
        return "time steps of 0.1 s per CPU second of one core (4 vessels, 75 items)"
    if "overhead" in key:
        return "share of the time of a step without our forces, from the same states"
    return "contacts per state"
