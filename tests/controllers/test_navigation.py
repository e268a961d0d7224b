"""The navigation filter beside a plain Kalman filter, and its covariance beside its errors."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import chi2

from mjforage.controllers.allocation import command_for, thrust_of
from mjforage.controllers.navigation import MARGIN, Navigator, SensorErrors
from mjforage.controllers.state import STATE
from tests.controllers.plant import FORAGER, SCOUT

FloatArray = NDArray[np.float64]
MODELS = np.array([SCOUT])
T = 0.1
ERRORS = SensorErrors(0.05, 0.5, 30.0, 0.05, np.radians(1.0), np.radians(5.0), 0, T)


@dataclass(frozen=True)
class Run:
    """Truth and measurements of one kind of track, (tick, episode, ...)."""

    pose: FloatArray
    seen: FloatArray
    velocity: FloatArray
    fix: NDArray[np.bool_]


def track(errors: SensorErrors, ticks: int, episodes: int, outage: slice = slice(0)) -> Run:
    """Vessels that go about in bends at 1 m/s, and what sensors with these errors show."""
    rng = np.random.default_rng(3)
    time = T * np.arange(ticks)[:, None]
    rate = 0.3 * np.sin(0.2 * time + rng.uniform(0, 6, episodes))
    yaw = rng.uniform(-3, 3, episodes) + T * np.cumsum(rate, axis=0) - 0.5 * T * rate
    ahead = np.tile(1.0 + 0.3 * np.cos(0.1 * time), (1, episodes))
    way = ahead[..., None] * np.stack((np.cos(yaw), np.sin(yaw)), axis=-1)
    xy = T * (np.cumsum(way, axis=0) - 0.5 * way - 0.5 * way[:1])
    fades = np.exp(-T / errors.memory_s)
    slow = np.empty((ticks, episodes, 2))
    slow[0] = rng.normal(size=(episodes, 2))
    for k in range(1, ticks):
        slow[k] = fades * slow[k - 1] + np.sqrt(1 - fades**2) * rng.normal(size=(episodes, 2))
    bias = errors.bias_rad * rng.normal(size=episodes)
    compass = yaw + bias + errors.heading_rad * rng.normal(size=yaw.shape)
    fixes = xy + errors.wander_m * slow + errors.position_m * rng.normal(size=xy.shape)
    log = np.stack((ahead, np.zeros_like(ahead)), axis=-1)
    log = log + errors.velocity_mps * rng.normal(size=log.shape)
    c, s = np.cos(compass), np.sin(compass)
    east, north = c * log[..., 0] - s * log[..., 1], s * log[..., 0] + c * log[..., 1]
    fix = np.ones((ticks, episodes), np.bool_)
    fix[outage] = False
    return Run(
        np.concatenate((xy, yaw[..., None]), axis=-1),
        np.concatenate((fixes, compass[..., None]), axis=-1),
        np.stack((east, north, rate), axis=-1),
        fix,
    )


def filtered(errors: SensorErrors, run: Run) -> list[dict[str, FloatArray]]:
    """What the filters tell at every tick, (episode, ...)."""
    ticks, episodes = run.fix.shape
    state, active = np.zeros((episodes, 1), STATE), np.ones(episodes, np.bool_)
    navigator = Navigator(errors, MODELS, state)
    found = []
    for k in range(ticks):
        now = run.seen[k][:, None], run.velocity[k][:, None], run.fix[k][:, None]
        told = navigator.update(active, *now)._asdict() | {"margin": state["margin"]}
        found.append({name: array[:, 0].copy() for name, array in told.items()})
    return found


def plain(errors: SensorErrors, run: Run) -> tuple[FloatArray, FloatArray]:
    """State and covariance at the end of the first episode: matrices, all measurements at once."""
    seen, velocity = run.seen[:, 0], run.velocity[:, 0]
    c, s = np.cos(seen[:, 2]), np.sin(seen[:, 2])
    log = np.stack(
        (
            c * velocity[:, 0] + s * velocity[:, 1],
            c * velocity[:, 1] - s * velocity[:, 0],
            velocity[:, 2],
        ),
        axis=-1,
    )
    noise = np.array([errors.position_m, errors.position_m, errors.heading_rad])
    slow = np.array([errors.wander_m, errors.wander_m, errors.bias_rad])
    x = np.concatenate((seen[0], np.zeros(3)))
    one, both = np.diag(noise**2), np.diag(slow**2)
    p = np.block([[one + both, -both], [-both, both]])
    h, fades = np.hstack((np.eye(3), np.eye(3))), np.exp(-T / errors.memory_s)
    q = np.zeros((6, 6))
    q[0, 0] = q[1, 1] = (T * errors.velocity_mps) ** 2
    q[2, 2] = 1e-8 * T
    q[3, 3] = q[4, 4] = errors.wander_m**2 * (1 - fades**2)
    for k in range(1, len(seen)):
        after = x[2] + 0.5 * T * (log[k - 1, 2] + log[k, 2])
        d = np.zeros(2)
        for yaw, (ahead, aside, _) in ((x[2], log[k - 1]), (after, log[k])):
            turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
            d += 0.5 * T * turn @ (ahead, aside)
        x = np.concatenate((x[:2] + d, [after], fades * x[3:5], x[5:]))
        f = np.diag([1.0, 1.0, 1.0, fades, fades, 1.0])
        f[0, 2], f[1, 2] = -d[1], d[0]
        p = f @ p @ f.T + q
        use = [0, 1, 2] if run.fix[k, 0] else [2]
        hk, r = h[use], np.diag(noise[use] ** 2)
        off = seen[k, use] - hk @ x
        off[-1] = (off[-1] + np.pi) % (2 * np.pi) - np.pi
        gain = p @ hk.T @ np.linalg.inv(hk @ p @ hk.T + r)
        x, p = x + gain @ off, (np.eye(6) - gain @ hk) @ p
    return x, p


def test_it_is_a_kalman_filter() -> None:
    run = track(ERRORS, 300, 1, slice(100, 200))
    last = filtered(ERRORS, run)[-1]
    x, p = plain(ERRORS, run)
    assert np.allclose(last["state"][0], x, atol=1e-9)
    assert np.allclose(last["covariance"][0], p, atol=1e-9)
    worst = np.sqrt(np.linalg.eigvalsh(last["covariance"][0][:2, :2])[-1])
    assert last["margin"][0] == pytest.approx(MARGIN * worst)


def test_its_errors_are_as_large_as_it_says() -> None:
    """Squared errors over the covariance have the mean of their chi-squared law, and so on later.

    Of position, heading and the compass's error, through an outage as well.
    """
    errors = ERRORS._replace(bias_rad=np.radians(2.0))
    run = track(errors, 900, 300, slice(500, 800))
    told = filtered(errors, run)
    for k in (1, 100, 499, 799, 899):
        off = told[k]["state"][:, :3] - run.pose[k]
        off[:, 2] = (off[:, 2] + np.pi) % (2 * np.pi) - np.pi
        p = told[k]["covariance"][:, :3, :3]
        sizes = np.einsum("ei,eij,ej->e", off, np.linalg.inv(p), off)
        low, high = (chi2.ppf(share, 3 * 300) / 300 for share in (0.0005, 0.9995))
        assert low < sizes.mean() < high
    margins = np.array([one["margin"].mean() for one in told])
    assert margins[799] > 1.2 * margins[499] and margins[899] < margins[799]
    assert margins[499] < margins[0]


def test_its_innovations_are_as_large_as_it_says() -> None:
    """Of 60 episodes 95 % have a sum within its 95 % band; all together lie within theirs."""
    told = filtered(ERRORS, track(ERRORS, 1000, 60))
    sums = np.sum([one["surprise"] for one in told], axis=0)
    counts = np.sum([one["measured"] for one in told], axis=0)
    assert (counts == 3 * 999).all()
    low, high = (chi2.ppf(share, counts[0]) for share in (0.025, 0.975))
    assert ((low < sums) & (sums < high)).mean() >= 0.9
    low, high = (chi2.ppf(share, counts.sum()) for share in (0.025, 0.975))
    assert low < sums.sum() < high


def test_the_track_tells_what_the_compass_is_off() -> None:
    run = track(ERRORS, 1200, 50)
    last = filtered(ERRORS, run)[-1]
    left = np.degrees(last["pose"][:, 2] - run.pose[-1, :, 2])
    left = (left + 180) % 360 - 180
    assert left.std() < 1.5  # of 5


@pytest.mark.parametrize("lost", [0.0, 0.2])
def test_a_latency_is_made_up_by_the_model(lost: float) -> None:
    """A vessel at rest 0.4 s ago is where its model has it under the thrusts since, in order."""
    errors = SensorErrors(0.0, 0.0, 60.0, 0.0, 0.0, 0.0, 4, T)
    state, active = np.zeros((1, 1), STATE), np.ones(1, np.bool_)
    navigator = Navigator(errors, MODELS, state)
    state["port_loss"] = state["starboard_loss"] = lost
    at, still, fix = np.zeros((1, 1, 3)), np.zeros((1, 1, 3)), np.ones((1, 1), np.bool_)
    forces = (9.0, 0.0, 0.0, 40.0, 20.0)
    for force in (0.0, 0.0, *forces):
        state["port"] = state["starboard"] = command_for(SCOUT, 0.5 * force / (1.0 - lost), 0.0)
        told = navigator.update(active, at, still, fix)
    p, x, u = SCOUT, 0.0, 0.0
    for force in forces[1:]:
        drag = p.linear_surge + p.quadratic_surge * u
        push = 2.0 * thrust_of(p, command_for(p, 0.5 * force, 0.0), u)
        u = (p.mass_surge_kg * u + T * push) / (p.mass_surge_kg + T * drag)
        x += T * u
    assert told.velocity[0, 0] == pytest.approx([u, 0.0, 0.0])
    assert told.pose[0, 0] == pytest.approx([x, 0.0, 0.0])
    state["port"] = command_for(SCOUT, -10.0 / (1.0 - lost), 0.0)  # turning to port on the spot
    for _ in range(4):
        told = navigator.update(active, at, still, fix)
    assert told.pose[0, 0, 2] > 0.05 and told.velocity[0, 0, 2] > 0.2
    assert abs(told.velocity[0, 0, 0]) < 1e-12


def test_episodes_are_independent_and_forgotten_alone() -> None:
    run = track(ERRORS, 40, 3)
    whole = filtered(ERRORS, run)[-1]
    alone = filtered(
        ERRORS, Run(run.pose[:, 1:2], run.seen[:, 1:2], run.velocity[:, 1:2], run.fix[:, 1:2])
    )
    for name, array in alone[-1].items():
        assert (array[0] == whole[name][1]).all()
    state, active = np.zeros((3, 1), STATE), np.array([True, True, False])
    navigator = Navigator(ERRORS, MODELS, state)
    for k in range(5):
        now = run.seen[k][:, None], run.velocity[k][:, None], run.fix[k][:, None]
        navigator.update(active, *now)
    assert (navigator.filters.ticks[:, 0] == [5, 5, 0]).all()
    navigator.reset(np.array([0]))
    assert (navigator.filters.ticks[:, 0] == [0, 5, 0]).all()
    assert all((each[0] == 0).all() for each in navigator.filters)


@pytest.mark.parametrize("one", [0, 1])
def test_each_vessel_of_a_fleet_has_a_filter_of_its_own(one: int) -> None:
    """Of two unlike vessels with other tracks, fixes and thrusts each is told what it is alone."""
    models, errors = np.array([SCOUT, FORAGER]), ERRORS._replace(latency=3)
    runs = track(errors, 60, 2, slice(20, 40))
    runs.fix[:, 1] = True  # only the first has an outage
    states = np.zeros((1, 2), STATE), np.zeros((1, 1), STATE)
    both = Navigator(errors, models, states[0])
    alone, active = Navigator(errors, models[one : one + 1], states[1]), np.ones(1, np.bool_)
    for k in range(60):
        for name, share in (("port", 0.2), ("starboard", 0.4)):
            states[0][name] = share * models["command_high"] * np.cos(0.1 * k)
            states[1][name] = states[0][name][:, one : one + 1]
        now = [each[k][None] for each in (runs.seen, runs.velocity, runs.fix)]
        told = both.update(active, *now)
        own = alone.update(active, *(each[:, one : one + 1] for each in now))
        for mine, theirs in zip(own, told, strict=True):
            np.testing.assert_array_equal(mine[:, 0], theirs[:, one])
    assert states[1]["margin"] == states[0]["margin"][:, one]
