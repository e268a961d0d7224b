"""Items that meet: closed forms, a plain oracle, piles in corners of quays."""

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from mjforage.forcing import LEEWAY
from mjforage.physics.floating import Afloat, Quays, separate
from mjforage.physics.floating.item_contacts import (
    AHEAD_M,
    PAIRS,
    SMALL,
    SWEEPS,
    TOUCH_M,
    Scratch,
    near_pairs,
)
from mjforage.physics.scene import build_scene
from mjforage.physics.simulation import Simulation
from mjforage.physics.vessels import load_vessel

RADIUS_M = 0.1
OPEN = np.zeros((0, 0), np.bool_)
BASIN = np.zeros((4, 4), np.bool_)  # (column + 2, row + 2): two by two nodes of water
BASIN[[0, -1]] = BASIN[:, [0, -1]] = True
PIER = np.zeros((5, 5), np.bool_)
PIER[2, 2] = True  # its corners stand out at 2 and 6 m
KINDS = np.array([[1.0, 0.01, 10.0], [3.0, 0.01, 10.0]])  # mass, drag
ONE = np.zeros(1, np.int64)
Array = NDArray[np.float64]


def quays_of(land: NDArray[np.bool_]) -> Quays:
    return Quays(land, 4.0, RADIUS_M, 1.0, 1.0, 0.9, 0.95, 0.001, 0.5, 2.0, 1.0)


def afloat_of(q: Array, v: Array, kind: Array, wind: tuple[float, float] = (0.0, 0.0)) -> Afloat:
    """One simulation of items (item, 2), of class -1 if they are not on the water."""
    winds = np.broadcast_to(np.array(wind), q.shape)[None].copy()
    active = np.zeros((1, len(q)), np.bool_)
    water = np.zeros((1, *q.shape))
    return Afloat(q[None].copy(), v[None].copy(), winds, water, kind[None].copy(), KINDS, active)


def separated(
    q: object,
    v: object,
    kind: object = None,
    land: NDArray[np.bool_] = OPEN,
    wind: tuple[float, float] = (0.0, 0.0),
    shift_s: float = 0.0,
) -> tuple[Array, Array]:
    """Places and velocities after one call."""
    places, speeds = np.array(q, np.float64), np.array(v, np.float64)
    kinds = np.zeros(len(places)) if kind is None else np.array(kind, np.float64)
    afloat = afloat_of(places, speeds, kinds, wind)
    separate(afloat, quays_of(land), shift_s, Scratch.of(len(places)), ONE)
    return afloat.q[0], afloat.v[0]


def gaps(xy: Array) -> Array:
    """Distance [m] of each two points beyond the sum of their radii."""
    apart = np.hypot(*(xy[:, None] - xy[None]).T)
    return np.asarray(apart[np.triu_indices(len(xy), 1)] - 2.0 * RADIUS_M)


def test_two_items_give_way_by_their_masses_and_go_on_as_one() -> None:
    """Of 3 kg and 1 kg, 4 cm into each other, at 1 m/s: (3 * 1 - 1 * 1) / 4 = 0.5 m/s."""
    q, v = separated([[0.0, 5.0], [0.16, 5.0]], [[1.0, 0.2], [-1.0, 0.0]], [1, 0])
    np.testing.assert_allclose(q, [[-0.01, 5.0], [0.19, 5.0]], atol=1e-12)
    np.testing.assert_allclose(v, [[0.5, 0.2], [0.5, 0.0]], atol=1e-12)


def test_items_that_part_or_are_apart_keep_their_bits() -> None:
    places, speeds = np.array([[0.1, 0.7], [0.3001, 0.7]]), np.array([[-0.3, 0.1], [0.1, 0.2]])
    q, v = separated(places, speeds, shift_s=0.0)
    assert (q == places).all() and (v == speeds).all()
    q, v = separated(places + np.array([[0.0, 0.0], [0.002, 0.0]]), -speeds)  # 2 mm apart
    assert (v == -speeds).all()


def test_places_are_those_of_the_velocities_moment() -> None:
    """Kept ahead by `shift_s` of the velocity, also of the new one."""
    shift, v = 0.05, np.array([[0.4, 0.0], [-0.4, 0.0]])
    xy = np.array([[0.0, 0.0], [0.18, 0.0]])
    q, after = separated(xy + shift * v, v, shift_s=shift)
    np.testing.assert_allclose(q - shift * after, [[-0.01, 0.0], [0.19, 0.0]], atol=1e-12)
    np.testing.assert_allclose(after, 0.0, atol=1e-12)


def test_items_in_one_place_come_apart() -> None:
    q, _ = separated([[1.0, 1.0]] * 2, [[0.0, 0.0]] * 2)
    assert abs(gaps(q)[0]) < 1e-12


def test_three_in_a_row_have_one_velocity_in_the_end() -> None:
    """The first one of 1 kg comes with 1 m/s to two that lie: 1 / (1 + 3 + 1) m/s."""
    q, v = [[0.0, 0.0], [0.2, 0.0], [0.4, 0.0]], [[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]]
    for _ in range(5):
        q, v = separated(q, v, [0, 1, 0], wind=(1.0, 0.0))  # type: ignore[assignment]
    np.testing.assert_allclose(np.array(v)[:, 0], 0.2, atol=2 * SMALL)
    np.testing.assert_allclose(np.array([1.0, 3.0, 1.0]) @ np.array(v), [1.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("side", [1, -1])
def test_a_row_is_stopped_by_a_quay_within_a_tick(axis: int, side: int) -> None:
    """Eight of them, 1 cm into each other and pressed on: the nth lies at (2 n + 1) radii."""
    face = 6.0 if side > 0 else -2.0
    q, v = np.full((8, 2), 1.0), np.zeros((8, 2))
    q[:, axis] = face - side * (RADIUS_M + 0.19 * np.arange(8))
    v[:, axis] = side * 0.3
    v[0] = 0.0
    toward = (8.0 * side * (axis == 0), 8.0 * side * (axis == 1))
    order = np.random.default_rng(0).permutation(8)
    q[order], v[order] = separated(q[order], v[order], order % 2, BASIN, toward)
    expected = face - side * RADIUS_M * (2 * np.arange(8) + 1)
    np.testing.assert_allclose(q[:, axis], expected, atol=1e-9)
    np.testing.assert_allclose(v, 0.0, atol=1e-9)


@pytest.mark.parametrize("land", [BASIN, PIER], ids=["basin", "pier"])
def test_no_item_is_pushed_into_a_quay(land: NDArray[np.bool_]) -> None:
    """Not even of many that start in a heap: at a side, in a corner, at corners that stand out."""
    places = {True: ((1.8, 1.8), (6.1, 1.85), (4.0, 6.2)), False: ((5.8, 3.0), (-1.8, -1.8))}
    for x, y in places[land is PIER]:
        q = np.array([x, y]) + np.random.default_rng(3).uniform(-0.2, 0.2, (40, 2))
        q = q[depth(q, land) < RADIUS_M]  # whose middle is over water
        for _ in range(40):
            before = depth(q, land)
            wind = (5.0, 5.0) if x > 0.0 else (-5.0, -5.0)
            q, _ = separated(q, np.zeros_like(q), None, land, wind)
            assert (depth(q, land) <= np.maximum(before, 0.0) + 1e-9).all()
        assert gaps(q).min() > -0.01


def depth(q: Array, land: NDArray[np.bool_]) -> Array:
    """(item,) how far each item, a disc, is in the nearest cell of land."""
    deep = np.full(len(q), -np.inf)
    for i, j in zip(*np.nonzero(land), strict=True):
        off = np.abs(q - 4.0 * np.array([i - 1, j - 1])) - 2.0
        outside = np.hypot(*np.maximum(off, 0.0).T)
        deep = np.maximum(deep, RADIUS_M - outside - np.minimum(off.max(axis=1), 0.0))
    return deep


def cloud(items: int = 120) -> tuple[Array, Array, Array]:
    """Items close together, some of them not on the water."""
    rng = np.random.default_rng(7)
    q, v = rng.uniform(-1.5, 1.5, (items, 2)), rng.normal(0.0, 0.2, (items, 2))
    return q, v, rng.integers(-1, 2, items).astype(np.float64)


def plain_pairs(q: Array, kind: Array, reach_m: float) -> list[tuple[int, int]]:
    on = np.flatnonzero(kind >= 0)
    near = itertools.combinations(on.tolist(), 2)
    return [(j, k) for j, k in near if np.hypot(*(q[j] - q[k])) < reach_m]


@pytest.mark.parametrize("scale", [0.3, 1.0, 30.0])
def test_neighbours_are_those_of_all_pairs(scale: float) -> None:
    q, v, kind = cloud()
    q *= scale
    expected, room = plain_pairs(q, kind, 0.25), np.empty((2, 7_000, 2), np.int64)
    afloat, scratch = afloat_of(q, v, kind), Scratch.of(len(q))
    count = near_pairs(afloat, 0, 0.25, scratch._replace(pairs=room))
    assert sorted(map(tuple, room[0, :count].tolist())) == expected
    assert near_pairs(afloat, 0, 0.25, scratch) == min(count, PAIRS * len(q))
    assert (scratch.pairs[0, : PAIRS * len(q)][:count] == room[0, :count][: PAIRS * len(q)]).all()


def plainly(q: Array, v: Array, kind: Array, wind: Array) -> None:
    """`separate` of the same pairs in open water, without bounds or memory that is used twice."""
    found, scratch, toward = afloat_of(q, v, kind), Scratch.of(len(q)), LEEWAY * wind
    count = near_pairs(found, 0, 2 * RADIUS_M + AHEAD_M, scratch)
    pairs = [(int(j), int(k)) for j, k in scratch.pairs[0, :count]]
    assert len(q) < count < PAIRS * len(q), "with room for all of them"
    pairs.sort(key=lambda pair: -min(q[k] @ toward for k in pair))
    pairs = [(j, k) if q[j] @ toward >= q[k] @ toward else (k, j) for j, k in pairs]
    mass = KINDS[kind.astype(int), 0]
    for _ in range(SWEEPS):
        most = 0.0
        for a, b in pairs:
            away = q[b] - q[a]
            gap = np.sqrt(away @ away)
            if gap >= 2 * RADIUS_M + TOUCH_M:
                continue
            n, share = away / gap, mass[b] / (mass[a] + mass[b])
            overlap = max(0.0, 2 * RADIUS_M - gap)
            approach = max(0.0, (v[a] - v[b]) @ n)
            for of, much in ((q, overlap), (v, approach)):
                of[a] -= share * much * n
                of[b] += (1.0 - share) * much * n
            most = max(most, overlap, approach)
        if most < SMALL:
            return


def test_a_cloud_is_parted_as_by_the_plain_oracle() -> None:
    q, v, kind = cloud()
    kind, wind = np.abs(kind), np.array([3.0, -2.0])
    got_q, got_v = separated(q, v, kind, wind=(3.0, -2.0))
    plain_q, plain_v = q.copy(), v.copy()
    plainly(plain_q, plain_v, kind, wind)
    np.testing.assert_allclose(got_q, plain_q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(got_v, plain_v, rtol=0, atol=1e-9)


def test_momentum_and_centre_of_mass_stay_in_open_water() -> None:
    q, v, kind = cloud()
    mass = np.where(kind < 0, 0.0, KINDS[kind.astype(int), 0])
    for _ in range(20):
        after_q, after_v = separated(q, v, kind, wind=(8.0, 1.0))
        np.testing.assert_allclose(mass @ after_v, mass @ v, atol=1e-11)
        np.testing.assert_allclose(mass @ after_q, mass @ q, atol=1e-11)
        assert (after_q[kind < 0] == q[kind < 0]).all()
        q, v = after_q, after_v
    assert gaps(q[kind >= 0]).min() > -0.01


def blown(sims: int, items: int, wide: int, seconds: float) -> tuple[Simulation, list[float]]:
    """A basin whose items the wind blows into a corner; the largest overlap in each tick [m]."""
    scene = build_scene([load_vessel("forager")], navigable=np.ones((3, 4), np.bool_), items=6)
    sim = Simulation(scene, sims, step_s=0.1, items=wide)
    rng = np.random.default_rng(4)
    q, kind = rng.uniform(4.0, 11.0, (3, wide, 2)), rng.integers(0, 5, (3, wide))
    q[..., 1] *= 0.8
    kind[:, items:] = -1
    sim.place_items(q[3 - sims :], kind[3 - sims :])
    sim.place_vessels(np.array([0.0, 0.0, 0.0]))
    gusts, overlap = rng.uniform(0.8, 1.2, round(seconds / 0.1)), []
    for gust in gusts:
        sim.item_wind[:] = np.array([6.4, 4.8]) * gust
        sim.step(1)
        sim.separate_items(np.arange(sims))
        overlap.append(-min(gaps(sim.item_xy[s, :items]).min() for s in range(sims)))
    return sim, overlap


def test_a_pile_in_a_corner_in_a_wind_of_8_mps() -> None:
    """No overlap beyond 1 cm after a second, none in the quays, and all come to rest."""
    sim, overlap = blown(1, 60, 60, 90.0)
    assert max(overlap[10:]) < 0.01
    xy, corner = sim.item_xy[0], np.array([14.0, 10.0])
    assert (corner - xy).min() > RADIUS_M - 0.01
    assert np.abs(sim.item_velocity).max() < 0.05
    area = len(xy) * np.sqrt(12.0) * RADIUS_M**2  # of the densest raft
    near = np.hypot(*(xy - corner).T)
    assert np.sqrt(4 * area / np.pi) < near.max() < 4.0 * np.sqrt(4 * area / np.pi)


def test_bits_do_not_depend_on_the_batch_or_on_its_width() -> None:
    alone, _ = blown(1, 40, 40, 30.0)
    beside, _ = blown(3, 40, 40, 30.0)
    assert alone.item_xy[0].tobytes() == beside.item_xy[2].tobytes()
