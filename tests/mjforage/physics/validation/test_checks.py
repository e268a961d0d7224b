"""Every check passes on the shipped physics, and fails once the physics is spoilt.

These are the tests of the issue's physical promises; other test files hold what a check does not.
"""

import itertools
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pytest

from mjforage.physics import callback
from mjforage.physics.callback import Route
from mjforage.physics.callback.model_layout import HEADER, HULL_WIDTH, ITEM_AIR, N_VESSELS
from mjforage.physics.dynamics.picking import Reach, take_at_mouth
from mjforage.physics.dynamics.watch import watch
from mjforage.physics.hydrodynamics.parameters import HULL
from mjforage.physics.simulation import InstabilityError, Integrator, mujoco_hull, simulation
from mjforage.physics.validation import (
    Finding,
    item_contacts,
    noted,
    repeats,
    rest,
    run_checks,
)
from mjforage.physics.validation.known_checks import check_names
from mjforage.physics.weather import Field

RUNS = 2  # of 900 s each; `mjforage validate --runs N` makes more
Fault = Callable[[mujoco.MjModel], None]
_count = itertools.count(1)


def of(name: str) -> Finding:
    (finding,) = run_checks([name], runs=RUNS)
    return finding


@pytest.mark.parametrize("name", [name for name in check_names() if name != "roll-pitch-heave"])
def test_check_passes(name: str) -> None:
    finding = of(name)
    failed = [measure for measure in finding.measures if not measure.passed]
    assert finding.status == "passed", failed


def test_planar_hulls_have_no_roll_to_check() -> None:
    assert of("roll-pitch-heave").status == "does not apply"


def scaled(name: str, factor: float) -> Fault:
    """One parameter of every vessel times a factor."""

    def fault(model: mujoco.MjModel) -> None:
        for v in range(int(model.numeric_data[N_VESSELS])):
            start = HEADER + v * HULL_WIDTH
            hull = model.numeric_data[start : start + HULL_WIDTH].view(HULL)
            hull[name] *= factor

    return fault


def pulled(model: mujoco.MjModel) -> None:
    """A steady pull on everything, to the north-east."""
    model.opt.gravity[:] = 0.1, 0.2, 0.0


def moored(model: mujoco.MjModel) -> None:
    """Drag against the ground."""
    model.dof_damping[:] = 0.5


def different(model: mujoco.MjModel) -> None:
    """Every model a little different."""
    model.dof_damping[:] = 1e-9 * next(_count)


def crude(model: mujoco.MjModel) -> None:
    """Forces of an instant under Euler's method."""
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.numeric_data[4] = 0.0


def draughty(model: mujoco.MjModel) -> None:
    """Items catch a quarter more of the wind."""
    start = HEADER + int(model.numeric_data[N_VESSELS]) * HULL_WIDTH + ITEM_AIR
    model.numeric_data[start::3] *= 1.25


def ghostly(model: mujoco.MjModel) -> None:
    """Nothing touches anything."""
    model.geom_contype[:] = model.geom_conaffinity[:] = 0


FAULTS: dict[str, Fault] = {
    "rest": pulled,
    "energy": scaled("linear_sway", -1.0),
    "straight": scaled("added_surge", 0.5),
    "speeds": scaled("k_ahead", 0.9),
    "turning-circle": scaled("added_sway", 0.95),
    "zigzag": scaled("added_yaw", 0.9),
    "crash-stop": scaled("k_astern", 0.95),
    "galilean": moored,
    "heading": pulled,
    "current": moored,
    "leeway": draughty,
    "wind-load": scaled("wind_delta", 1.2),
    "drift": scaled("wind_side", 0.98),
    "step-halving": crude,
    "fast-reference": crude,
    "determinism": different,
    "endurance": scaled("linear_sway", -1e3),
    "quay-force": pulled,
    "ramming": scaled("added_sway", 0.9),
    "items": ghostly,
    "added-mass": scaled("added_sway", 0.9),
}


@pytest.mark.parametrize("name", FAULTS)
def test_check_notices_a_fault(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rest, "REST_S", 30.0)
    monkeypatch.setattr(
        repeats, "elsewhere", lambda: [repeats.digest(repeats.states(kind)) for kind in Integrator]
    )

    def spoil(prepared: Callable[..., mujoco.MjModel]) -> Callable[..., mujoco.MjModel]:
        def spoilt(*arguments: Any) -> mujoco.MjModel:
            model = prepared(*arguments)
            FAULTS[name](model)
            return model

        return spoilt

    for room in (simulation, mujoco_hull):
        monkeypatch.setattr(room, "prepared", spoil(room.prepared))
    assert of(name).status == "failed"


@pytest.mark.parametrize("hurry", [0.8, 1.25])
def test_gusts_of_another_memory_are_noticed(hurry: float, monkeypatch: pytest.MonkeyPatch) -> None:
    wind = Field.wind
    monkeypatch.setattr(Field, "wind", lambda self, t, xy: wind(self, hurry * t, xy))
    assert of("gusts").status == "failed"


@pytest.mark.parametrize(
    ("name", "place", "what", "share"),
    [
        ("circulation", Field, "current", 0.95),
        ("drawn-weather", Field, "item_noise", 0.95),
        ("drawn-weather", Field, "current", 0.9),
        ("drawn-weather", Field, "wind", 1.05),
    ],
)
def test_weather_of_another_strength_is_noticed(
    name: str, place: Any, what: str, share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    true = getattr(place, what)
    monkeypatch.setattr(place, what, lambda *arguments: share * true(*arguments))
    assert of(name).status == "failed"


def test_a_longer_mouth_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def longer(reach: Reach, *rest: Any) -> int:
        return int(take_at_mouth(reach._replace(size=np.add(reach.size, (0.01, 0.0))), *rest))

    monkeypatch.setattr(item_contacts, "take_at_mouth", longer)
    assert of("mouth").status == "failed"


@pytest.mark.parametrize(
    ("name", "entry"), [("touch-speed", "impact_mps"), ("energy-drawn", "work_j")]
)
def test_notes_that_are_off_are_noticed(
    name: str, entry: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def off(harbour: Any, seen: Any, on: Any, tick: Any) -> None:
        watch(harbour, seen, on, tick)
        getattr(seen, entry)[:] *= 0.98

    monkeypatch.setattr(noted, "watch", off)
    assert of(name).status == "failed"


@pytest.mark.parametrize("name", ["quay-force", "galilean", "added-mass"])
def test_the_python_route_passes_too(name: str) -> None:
    callback.uninstall()
    callback.install(Route.PYTHON)
    try:
        assert of(name).status == "passed"
    finally:
        callback.install(Route.NATIVE)


def test_no_check_is_without_its_fault() -> None:
    others = {"gusts", "circulation", "drawn-weather", "mouth", "touch-speed", "energy-drawn"}
    assert set(check_names()) == set(FAULTS) | others | {"roll-pitch-heave"}


def test_an_unstable_simulation_fails_its_check(monkeypatch: pytest.MonkeyPatch) -> None:
    def unstable(self: Any, steps: int = 1) -> None:
        raise InstabilityError("physics: unstable at seed 0, t = 1.00 s, body otter_0")

    monkeypatch.setattr(simulation.Simulation, "step", unstable)
    finding = of("rest")
    assert finding.status == "failed"
    assert "body otter_0" in finding.measures[0].what
    assert np.isnan(finding.measures[0].value)
