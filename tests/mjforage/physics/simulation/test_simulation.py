import contextlib
import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mjforage.base.errors import UserError
from mjforage.physics.port_drive import (
    drive,
    port_scene,
    port_simulation,
)
from mjforage.physics.scene import build_scene, with_bodies
from mjforage.physics.simulation import InstabilityError, Integrator, Simulation
from mjforage.physics.simulation.instability import warnings_suppressed
from mjforage.physics.simulation.integrators import prepared
from mjforage.physics.vessels import load_vessel

OTTER = load_vessel("otter")
PORT = port_scene()
BOTH = pytest.mark.parametrize("integrator", Integrator)


@BOTH
def test_a_copied_state_resumes_to_the_bit(integrator: Integrator) -> None:
    first = port_simulation(PORT, integrator, 2)
    drive(first, 30.0)
    saved, scene = first.snapshot(), first.scene
    drive(first, 20.0, seed=1)
    second = Simulation(scene, 2, integrator=integrator, step_s=0.1, items=first.items)
    second.restore(saved)
    drive(second, 20.0, seed=1)
    np.testing.assert_array_equal(second.snapshot(), first.snapshot())


def test_looks_change_no_bit_of_the_motion() -> None:
    bare, shown = (
        port_simulation(build_scene(PORT.vessels, items=75, looks=looks), Integrator.FAST, 1)
        for looks in (None, [0] * 75)
    )
    drive(bare, 30.0)
    drive(shown, 30.0)
    np.testing.assert_array_equal(shown.snapshot(), bare.snapshot())


@BOTH
def test_the_size_of_the_pool_changes_no_bit(integrator: Integrator) -> None:
    """Nor that it grows on the way, which the smallest of these does."""
    ends = []
    for bodies in (1, 8, 60):
        simulation = port_simulation(with_bodies(PORT, bodies), integrator, 4)
        drive(simulation, 60.0)
        ends.append((simulation.item_xy, simulation.vessel_pose, simulation.scene.items))
    for xy, pose, _ in ends[1:]:
        np.testing.assert_array_equal(xy, ends[0][0])
        np.testing.assert_array_equal(pose, ends[0][1])
    assert ends[0][2] > 1 and ends[2][2] == 60


@pytest.mark.parametrize("integrator", [*Integrator])
def test_the_solver_sums_and_stops_alike_with_any_pool(integrator: Integrator) -> None:
    """Sums of the dense solver do not see bodies that touch nothing; nor does its tolerance."""
    made = [prepared(with_bodies(PORT, bodies), integrator, 0.02) for bodies in (1, 8, 60)]
    assert {one.opt.jacobian for one in made} == {mujoco.mjtJacobian.mjJAC_DENSE}
    inertia = [one.stat.meaninertia * one.nv for one in made]
    assert inertia == pytest.approx([inertia[0]] * 3, rel=1e-15)


def test_parked_items_do_not_move() -> None:
    simulation = Simulation(build_scene([OTTER], items=3))
    simulation.item_wind[:] = 20.0, 5.0
    simulation.place_items(np.array([9.0, 9.0]), np.array([-1, 0, -1]))
    simulation.step(100)
    parking = simulation.scene.parking
    np.testing.assert_array_equal(simulation.item_xy[0, ::2], parking[::2])
    assert simulation.item_xy[0, 1, 0] > 9.5
    simulation.remove_items(np.array([[False, True, False]]))
    simulation.step(100)
    np.testing.assert_array_equal(simulation.item_xy[0], parking)


def test_reset_by_mask_leaves_the_others_alone() -> None:
    simulation = port_simulation(PORT, Integrator.FAST, 3)
    drive(simulation, 10.0)
    before = simulation.snapshot()
    simulation.reset(np.array([False, True, False]))
    np.testing.assert_array_equal(simulation.snapshot()[::2], before[::2])
    assert simulation.time_s.tolist() == [before[0, 0], 0.0, before[2, 0]]
    assert (simulation.item_class[1] == -1.0).all()
    simulation.step(10, ids=np.array([1]))
    np.testing.assert_array_equal(simulation.snapshot()[::2], before[::2])
    assert simulation.time_s[1] == pytest.approx(1.0)


def far(simulation: Simulation) -> None:
    """Beyond MuJoCo's largest position."""
    simulation.place_vessels(np.array([[0.0, 0.0, 0.0], [1e11, 0.0, 0.0]]), ids=np.array([1]))


def fast(simulation: Simulation) -> None:
    """Beyond MuJoCo's largest velocity, at a place within."""
    at = np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]])
    simulation.place_vessels(at, at * (1.5e10 / 9.0), ids=np.array([1]))


def pulled(simulation: Simulation) -> None:
    """Water of a speed that no number holds the square of."""
    simulation.vessel_water[1, 1] = 1e160, 0.0


@pytest.mark.parametrize(
    ("spoil", "label"), [(far, "BADQPOS"), (fast, "BADQVEL"), (pulled, "BADQACC")]
)
def test_instability_names_seed_time_and_body(
    spoil: Callable[[Simulation], None],
    label: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    scene = build_scene([OTTER, OTTER], names=("calm", "wild"), items=1)
    simulation = Simulation(scene, 3, step_s=0.1, seeds=[11, 22, 33])
    simulation.place_vessels(np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]]))
    simulation.step(10)
    spoil(simulation)
    with pytest.raises(InstabilityError, match=rf"seed 22, t = 1.00 s, body wild \({label}\)"):
        simulation.step(10, np.array([1, 2]))  # the first one is over
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("step_s", [0.05, 0.1, 0.5])
def test_the_fast_integrator_solves_the_lag_exactly(step_s: float) -> None:
    """After a step of h, c (1 - exp(-h / lag)): Euler's c h / lag overshoots from h = lag on."""
    crew = [OTTER, load_vessel("scout")]
    simulation = Simulation(build_scene(crew), step_s=step_s)
    simulation.commands[0] = command = np.array([[60.0, -40.0], [20.0, -10.0]])
    simulation.place_vessels(np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]]))
    simulation.step()
    risen = np.array([[1.0 - math.exp(-step_s / vessel.lag_s)] for vessel in crew])
    np.testing.assert_allclose(simulation.thruster_state[0], risen * command, rtol=1e-12)


def test_steps_that_runge_kutta_cannot_take_are_named() -> None:
    """Twice the lag is the limit; Runge-Kutta of order 4 is unstable from 2.785 on."""
    quick = dataclasses.replace(load_vessel("scout"), lag_s=0.04)
    scene = build_scene([OTTER, quick])
    Simulation(scene, integrator=Integrator.REFERENCE, step_s=0.08)
    Simulation(scene, integrator=Integrator.FAST, step_s=0.5)
    with pytest.raises(UserError, match=r"step 0.1 s .* lag_s = 0.04 s of scout_1; .* 0.08 s"):
        Simulation(scene, integrator=Integrator.REFERENCE, step_s=0.1)


def test_warnings_are_suppressed_until_the_last_has_left() -> None:
    """Whoever entered first: contexts of threads end in any order."""
    assert mujoco.get_mju_user_warning() is None
    first, second = contextlib.ExitStack(), contextlib.ExitStack()
    for one in (first, second):
        one.enter_context(warnings_suppressed())
    first.close()
    assert mujoco.get_mju_user_warning() is not None
    second.close()
    assert mujoco.get_mju_user_warning() is None


@pytest.mark.parametrize("integrator", Integrator)
def test_vessels_are_where_they_are_placed_with_way_on_too(integrator: Integrator) -> None:
    simulation = Simulation(build_scene([load_vessel("otter")]), integrator=integrator)
    pose, velocity = np.array([[[3.0, -2.0, 0.7]]]), np.array([[[1.5, -0.4, 0.3]]])
    simulation.place_vessels(pose, velocity)
    np.testing.assert_allclose(simulation.vessel_pose, pose, atol=1e-12)
    np.testing.assert_array_equal(simulation.vessel_velocity, velocity)


@pytest.mark.parametrize("integrator", Integrator)
def test_each_vessel_of_a_scene_moves_by_its_own_numbers(integrator: Integrator) -> None:
    hulls = [OTTER, load_vessel("scout")]
    way = []
    for those in (hulls, hulls[:1], hulls[1:]):
        simulation = Simulation(build_scene(those), integrator=integrator)
        simulation.place_vessels(np.array([[0.0, 50.0 * k, 0.0] for k in range(len(those))]))
        simulation.commands[:] = 5.0
        simulation.step(100)
        way.append(simulation.vessel_velocity[0, :, 0])
    np.testing.assert_allclose(way[0], np.concatenate(way[1:]), rtol=1e-9)
    assert abs(way[0][0] - way[0][1]) > 0.01


def test_hulls_are_met_ahead_and_items_where_they_are() -> None:
    """Margins of a pair add up: two steps of the fastest boat between hulls, nothing to an item."""
    model = prepared(with_bodies(PORT, 2), Integrator.FAST, 0.1)
    hull, item = (set(model.geom_margin[model.geom_contype == kind]) for kind in (2, 4))
    (reach,), (back,) = hull, item
    assert reach + back == 0.0
    assert 0.1 * 2.5 < reach < 0.1 * 4.0
    np.testing.assert_array_equal(
        model.body_margin[model.geom_bodyid[model.geom_contype == 4]], back
    )
