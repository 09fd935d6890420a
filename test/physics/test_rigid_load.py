"""The rigid load in its sling: rest, energy, pendulum, point-mass limit, yaw and pitch, release, safety."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from rigid_rig import DRY, FLOOR, LEVEL, UNDAMPED, G, around, box_load, hanging, lying, plane, run
from scipy.spatial.transform import Rotation
from wire_rig import WINCH

from shipcrane_twin.physics.payload import hanging_wire
from shipcrane_twin.physics.rigid_load import LANDING, LIFT_OFFS, SLUNG, rigid_micro_steps, springs_at
from shipcrane_twin.physics.rigid_step import rigid_step, slung_state
from shipcrane_twin.physics.winch import COASTING, POWERED, TOLD, winch_at_rest, winch_step
from shipcrane_twin.physics.wire import STEP_MIN
from shipcrane_twin.validation.lifting_wire import FIXED, WIRE

STEP = 0.02


def total_energy(load, states, wire):
    """Kinetic, and total energy of hook, load, wire and legs."""
    rows = []
    for state in states:
        springs = springs_at(wire, load, state[19], state[SLUNG] > 0.0)
        rot = Rotation.from_quat(state[12:16]).as_matrix()
        kinetic = 0.5 * springs.hook_inertia * state[3:6] @ state[3:6] + 0.5 * load.mass * state[9:12] @ state[9:12]
        kinetic += 0.5 * load.inertia @ state[16:19] ** 2
        potential = springs.hook_weight * state[2] + load.mass * G * state[8]
        stretches = [(np.linalg.norm(state[:3] - FIXED[:3]) - state[19], springs.stiffness)]
        for lug in load.lugs:
            span = np.linalg.norm(state[:3] - state[6:9] - rot @ lug) - load.leg_length
            stretches.append((span, load.leg_stiffness))
        elastic = sum(0.5 * k * max(0.0, s) ** 2 for s, k in stretches)
        rows.append((kinetic, kinetic + potential + elastic))
    return np.array(rows).T


def swung(load, wire=WIRE, length=4.0, speed=1.5, spin=(0.1, 0.2, 0.3)):
    state = hanging(load, wire, length)
    state[3], state[9], state[10] = speed, speed, 0.5 * speed
    state[16:19] = spin
    return state


def test_hanging_load_rests_and_pulls_with_all_weight():
    load = box_load()
    state = hanging(load)
    states, forces = run(load, state, STEP, 50)
    np.testing.assert_allclose(states[-1, :19], state[:19], atol=1e-9)
    np.testing.assert_allclose(forces[-1], [0.0, 0.0, -5200.0 * G, 5200.0 * G], rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("step_s", [0.02, 0.1])
def test_undamped_load_with_its_sling_keeps_its_energy(step_s, measured):
    load = box_load()
    states, _ = run(load, swung(load, UNDAMPED), step_s, round(30.0 / step_s), UNDAMPED)
    kinetic, total = total_energy(load, states, UNDAMPED)
    assert np.abs(states[:, 16:19]).max() > 0.3
    drift = np.abs(total - total[0]).max() / np.ptp(kinetic)
    measured(f"energy of the undamped load with sling over 30 s, H = {1e3 * step_s:g} ms: drift", drift, 1e-5)


def test_damping_only_takes_energy():
    load = box_load()
    _, total = total_energy(load, run(load, swung(load), STEP, 300)[0], WIRE)
    assert np.diff(total).max() <= 1e-9 * abs(total[0])


def test_across_its_lugs_it_swings_as_a_compound_pendulum(measured):
    # about the line of the lugs, hook held by a very long-lived trick: a hook so heavy that it stands still
    load = box_load(hook=1e6, leg_length=2.0)
    state = hanging(load, length=0.5)
    state[16] = 0.02  # about the box's length; it then turns about the line hook - CoG of the triangle
    states, _ = run(load, state, 0.01, 1200)
    roll = Rotation.from_quat(states[:, 12:16]).as_euler("xyz")[:, 0]
    falls = np.flatnonzero((roll[:-1] > 0.0) & (roll[1:] <= 0.0))
    crossings = 0.01 * (falls + roll[falls] / (roll[falls] - roll[falls + 1]))
    # two modes, sling triangle and box about its lugs: their rates from the linear double pendulum
    arm = state[2] - state[8] - 1.0
    below = 1.0
    mass = load.mass * np.array([[arm**2, arm * below], [arm * below, below**2]])
    mass[1, 1] += load.inertia[0]
    stiffness = load.mass * G * np.diag([arm, below])
    rates = np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)
    spectrum = np.abs(np.fft.rfft((roll - roll.mean()) * np.hanning(len(roll)), 16 * len(roll)))
    found = 2.0 * np.pi * np.fft.rfftfreq(16 * len(roll), 0.01)[np.argmax(spectrum)]
    assert len(crossings) > 3
    measured("swing of a box in its sling against the linear double pendulum", np.abs(found / rates - 1.0).min(), 0.02)


def test_a_small_box_on_a_stiff_sling_sways_as_a_point_mass(measured):
    load = box_load(mass=700.0, hook=1.0, size=np.array([0.2, 0.2, 0.2]), leg_length=0.5)
    state = hanging(load, length=9.0)
    depth = FIXED[2] - state[8]
    state[3], state[9] = 0.05 * (FIXED[2] - state[2]) / depth, 0.05
    states, _ = run(load, state, STEP, 700)
    sway = states[:, 6] - FIXED[0]
    falls = np.flatnonzero((sway[:-1] > 0.0) & (sway[1:] <= 0.0))
    times = STEP * (falls + sway[falls] / (sway[falls] - sway[falls + 1]))
    period = 2.0 * np.pi * np.sqrt(depth / G)
    measured("period of a small slung box against a point mass", abs(np.diff(times)[0] / period - 1.0), 1e-2)


def test_a_load_with_its_cog_beside_the_middle_pitches_until_it_hangs_below_the_hook():
    load = box_load(centre=(0.3, 0.0, 0.0))
    states, _ = run(load, hanging(load), STEP, 9000, WIRE._replace(damping_ratio=2.0))
    late = states[-3000:]
    below = late[:, 6:8] - FIXED[:2]
    pitch = Rotation.from_quat(late[:, 12:16]).as_euler("xyz")[:, 1]
    assert np.abs(below.mean(axis=0)).max() < 0.03
    assert abs(pitch.mean()) > 0.02


def test_wind_pushes_a_slung_box_aside_by_drag_over_weight(measured):
    load = box_load(air=0.5 * 1.226 * 1.2)
    state = hanging(load, length=6.0)
    states, _ = run(load, state, STEP, 3000, surroundings=around(wind=(0.0, 12.0, 0.0)))
    tilt = 0.5 * 1.226 * 1.2 * 8.0 * 12.0**2 / (5000.0 * G)
    drag = 0.5 * 1.226 * 1.2 * (8.0 + 12.0 * tilt) * 12.0**2  # the wind sees a little of the bottom
    hang = np.average(states[-2500:, 1] - FIXED[1], weights=np.hanning(2500)) / 6.0
    measured("hook's lean in the wind against drag over weight", abs(hang / (drag / (5200.0 * G)) - 1.0), 0.02)


def test_wind_beside_the_cog_turns_the_box():
    load = box_load(centre=(0.5, 0.0, 0.0), air=0.7)
    states, _ = run(load, hanging(load), STEP, 200, surroundings=around(wind=(0.0, 15.0, 0.0)))
    assert Rotation.from_quat(states[-1, 12:16]).as_euler("zyx")[0] > 0.02


def test_released_it_falls_and_the_hook_stays():
    load = box_load()
    state = hanging(load)
    state[SLUNG] = 0.0
    states, forces = run(load, state, STEP, 400)
    assert states[25, 8] == pytest.approx(states[0, 8] - 0.5 * G * 0.5**2, rel=1e-6)
    assert forces[-1, 3] == pytest.approx(200.0 * G, rel=1e-3)


def test_it_is_picked_up_from_a_heaving_deck(measured):
    """The hook goes up, the legs go taut, the load leaves the deck and hangs with all its weight."""
    load = box_load(planes=FLOOR)
    rate, start = 1.1, 1.0 - 5000.0 * G / 16e6
    state = slung_state(WIRE, load, FIXED[:3], 8.0, LEVEL, np.array([1.0, -2.0, start]), True)

    def deck(t):
        return plane((0.0, 0.0, 0.2 * np.sin(rate * t)), velocity=(0.0, 0.0, 0.2 * rate * np.cos(rate * t)))

    winch = WINCH._replace(motor_torque=1e6, brake_torque=1e6)
    memory, states, tensions = winch_at_rest(winch, STEP), [state], []
    for k in range(750):
        told = memory[TOLD]
        memory, hold = winch_step(winch, memory, states[-1][19], -0.5 if k > 50 else 0.0, False, POWERED, STEP)
        now = around(planes=deck(k * STEP), planes_next=deck((k + 1) * STEP))
        new, _, tension = rigid_step(WIRE, hold, load, states[-1], told, memory[TOLD], now, STEP)
        states.append(new)
        tensions.append(tension)
    states = np.array(states)
    deck_z = 0.2 * np.sin(rate * STEP * np.arange(len(states)))
    rides = states[:, LANDING + LIFT_OFFS] == 0.0
    assert np.abs(states[:100, 8] - deck_z[:100] - start).max() < 0.02
    assert states[-1, LANDING + LIFT_OFFS] >= 1.0
    assert 100 < np.count_nonzero(rides) < 700
    assert states[-1, 8] > 2.0
    assert np.mean(tensions[-100:]) == pytest.approx(5200.0 * G, rel=0.05)
    assert np.isfinite(states).all()


@settings(deadline=None, max_examples=40)
@given(
    log_length=st.floats(np.log(0.2), np.log(100.0)),
    log_mass=st.floats(0.0, np.log(5e4)),
    hook_share=st.floats(1e-3, 1.0),
    step_s=st.floats(0.001, 0.2),
    seed=st.integers(0, 999),
    wet=st.booleans(),
    drive=st.sampled_from([POWERED, COASTING]),
)
@example(np.log(0.2), 0.0, 1e-3, 0.2, 0, False, POWERED)
@example(np.log(0.2), np.log(5e4), 1e-3, 0.2, 1, False, POWERED)
@example(np.log(100.0), np.log(5e4), 1.0, 0.2, 2, True, COASTING)
def test_no_length_mass_or_step_blows_up(log_length, log_mass, hook_share, step_s, seed, wet, drive):
    rng = np.random.default_rng(seed)
    length, mass = np.exp(log_length), np.exp(log_mass)
    size = (mass / 400.0) ** (1.0 / 3.0) * rng.uniform(0.5, 1.5, 3)
    load = box_load(mass, hook_share * mass, FLOOR, size, 0.7, leg_length=float(size[0]))
    state = hanging(load, WIRE, length)
    state[3:6], state[9:12] = 0.5 * rng.normal(size=(2, 3))
    state[16:19] = 0.5 * rng.normal(size=3)
    state[:3] -= (state[:3] - FIXED[:3]) * rng.uniform(0.0, 5e-3)
    water = np.array([FIXED[2] - length, 0.3, 0.2, 0.5, 0.1, 0.2, 0.3]) if wet else DRY
    floor = plane((0.0, 0.0, FIXED[2] - length - size[0]))
    memory = winch_at_rest(WINCH, step_s)
    assert rigid_micro_steps(WIRE, load, length, True, step_s) <= 1.05 * step_s / STEP_MIN + 1
    energy_most = mass * G * (length + 10.0)
    for _ in range(20):
        memory, hold = winch_step(WINCH, memory, state[19], rng.choice([np.nan, 0.5, -0.5]), False, drive, step_s)
        state, force, _ = rigid_step(
            WIRE, hold, load, state, 0.0, memory[TOLD], around(planes=floor, water=water), step_s
        )
    assert np.isfinite(state).all()
    assert np.isfinite(force).all()
    assert 0.5 * mass * state[9:12] @ state[9:12] < energy_most


def test_the_hook_moves_with_its_own_inertia_unless_it_is_very_light():
    assert springs_at(WIRE, box_load(), 4.0, True).hook_inertia == 200.0
    light = springs_at(WIRE, box_load(hook=1e-3), 4.0, True)
    assert 1e-3 < light.hook_inertia < 0.1 * 5000.0
    assert light.hook_weight == pytest.approx(1e-3 * G)
    assert hanging_wire(WIRE, 4.0, 5200.0, 5200.0 * G)[0] == springs_at(WIRE, box_load(), 4.0, True).stiffness


def test_a_step_leaves_its_inputs_alone():
    load = box_load(planes=FLOOR)
    state, there = lying(load, 0.99), around(planes=plane())
    kept = [state.copy(), *(part.copy() for part in there)]
    run(load, state, STEP, 1, surroundings=there)
    for now, before in zip([state, *there], kept, strict=True):
        np.testing.assert_array_equal(now, before)
