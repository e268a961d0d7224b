import pytest

from mjforage.physics.worlds import WORLDS, ladder_of
from mjforage.scenario.scenario import Scenario
from mjforage.scenario.scenario_file import load_scenario

WEATHER = load_scenario("comb-port-weather")


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ((), ("graph", "hulls", "calibrated", "debris", "intake", "physics")),
        (("physics.capture=node",), ("graph", "hulls", "debris", "physics")),
        (
            (
                "weather.gust_intensity=0.0",
                "sensors.position_noise_m=0.0",
                "sensors.heading_noise_deg=0.0",
                "sensors.detection=1.0",
                "sensors.camera_noise_m=0.0",
                "sensors.camera_fov_deg=127.0",
            ),
            ("graph", "hulls", "calibrated", "debris", "physics"),
        ),
        (
            ("sensors.detection=0.9",),
            ("graph", "hulls", "calibrated", "debris", "intake", "physics"),
        ),
        (("rules.capture=calibrated",), ("graph", "hulls", "debris", "intake", "physics")),
    ],
)
def test_rungs_that_a_scenario_lacks_are_left_out(
    overrides: tuple[str, ...], expected: tuple[str, ...]
) -> None:
    assert ladder_of(load_scenario("comb-port-weather", overrides)) == expected


def test_the_default_port_has_only_vessels_and_bodies() -> None:
    assert ladder_of(load_scenario("comb-port")) == ("graph", "hulls", "physics")


def whole(*values: float) -> bool:
    """Whether a piece is there; all that belongs to it comes and goes together."""
    (there,) = {value > 0.0 for value in values}
    return there


def pieces(scenario: Scenario) -> tuple[bool, ...]:
    """Chance, bodies, current, intake, gusts, noise."""
    weather, physics, sensors = scenario.weather, scenario.physics, scenario.sensors
    return (
        scenario.rules.capture == "calibrated",
        physics.items == "bodies",
        whole(weather.circulation_mps, weather.current_wander_mps),
        physics.capture == "intake",
        (weather.gust_intensity or 0.0) > 0,
        whole(sensors.position_noise_m, sensors.heading_noise_deg, sensors.camera_noise_m),
    )


def test_each_world_adds_its_piece() -> None:
    table = {name: pieces(kind.adapt(WEATHER)) for name, kind in WORLDS.items() if name != "graph"}
    assert table == {
        "hulls": (False, False, False, False, False, False),
        "calibrated": (True, False, False, False, False, False),
        "debris": (False, True, True, False, False, False),
        "intake": (False, True, True, True, False, False),
        "physics": (False, True, True, True, True, True),
    }


def test_wind_and_drift_are_the_same_in_every_world() -> None:
    for kind in WORLDS.values():
        weather = kind.adapt(WEATHER).weather
        assert weather.drift_node_per_step == WEATHER.weather.drift_node_per_step
        assert weather.noise_node_per_step == WEATHER.weather.noise_node_per_step
