"""A rigid load in a two-legged sling under a hook on the wire: its constants, its state and its motion at one instant.

State, float64 (32,): hook, position and velocity (6); load, position of its CoG (3), velocity (3), quaternion
x y z w (4) and angular velocity in its own axes (3); paid-out length and its rate; 1 while slung; record of snaps
(5), see `wire`; record of landings (5): time without contact [s], how many landings, latest and fastest speed of impact
[m/s], how many lift-offs.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.box_wind import box_wind
from shipcrane_twin.physics.contact import STIFFNESS, contact_load
from shipcrane_twin.physics.frames import matrix_from_quat, quat_rate
from shipcrane_twin.physics.payload import WireParams, carried, hanging_wire, least_mass
from shipcrane_twin.physics.splash import SplashParams, splash_load
from shipcrane_twin.physics.wire import STEP_MIN, pull, wire_loss

POSITION, VELOCITY, QUAT, TURNING = 6, 9, 12, 16
LENGTH, SPEED, SLUNG, RECORD, LANDING = 19, 20, 21, 22, 27
"""Columns of the state; the first 19 are those that move by themselves."""

APART, LANDINGS, IMPACT, IMPACT_MAX, LIFT_OFFS = range(5)
"""Columns of the record of landings."""


class RigidParams(NamedTuple):
    """Constants of hook, sling and load; see `make_rigid`.

    Attributes
    ----------
    hook_mass, mass : float
        [kg].
    inertia : float64, shape (3,)
        About the load's axes through its CoG, which are principal ones [kg m2].
    lugs : float64, shape (2, 3)
        Where the legs are fast, seen from the CoG, load's axes [m].
    leg_length, leg_stiffness : float
        Of each leg [m], [N/m].
    corners : float64, shape (8, 3)
        Seen from the CoG [m].
    radius : float
        Greatest distance of a corner from the CoG [m].
    splash : SplashParams
    air_drag : float
        ``rho C_D / 2`` [kg/m3].
    planes : float64, shape (n, 6)
        Constants of the rectangles that it may touch, see `contact`.
    rate_max : float
        Upper bound of the rates at which legs and contacts let the load vibrate [rad/s].
    """

    hook_mass: float
    mass: float
    inertia: Array
    lugs: Array
    leg_length: float
    leg_stiffness: float
    corners: Array
    radius: float
    splash: SplashParams
    air_drag: float
    planes: Array
    rate_max: float


def make_rigid(
    *,
    hook_mass: float,
    mass: float,
    lugs: Array,
    leg_length: float,
    leg_stiffness: float,
    splash: SplashParams,
    air_drag: float,
    planes: Array,
    phase_max: float,
) -> RigidParams:
    """Return the constants of a load that is a box of even density, its CoG shifted from the middle.

    Notes
    -----
    Legs and contacts are no stiffer than micro steps of `STEP_MIN` resolve, as the wire in `resolved_stiffness`;
    the bound on the rates adds up what each spring gives along and across its lever, so it is never too low.
    """
    size, centre = splash.size, splash.centre
    square = size * size
    inertia = mass / 12.0 * (square.sum() - square)
    signs = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    corners = centre + signs * size

    def softness(point: Array) -> float:
        return float(1.0 / mass + ((point @ point - point * point) / inertia).sum())

    by_legs = sum(softness(lug) for lug in lugs)
    by_corners = 0.5 * sum(softness(corner) for corner in corners)
    most = (phase_max / STEP_MIN) ** 2
    leg = min(leg_stiffness, 0.5 * most / by_legs)
    held = planes.copy()
    held[:, STIFFNESS] = np.minimum(planes[:, STIFFNESS], 0.5 * most / by_corners)
    hardest = held[:, STIFFNESS].max() if len(held) else 0.0
    return RigidParams(
        hook_mass=hook_mass,
        mass=mass,
        inertia=inertia,
        lugs=lugs,
        leg_length=leg_length,
        leg_stiffness=leg,
        corners=corners,
        radius=float(np.linalg.norm(corners, axis=1).max()),
        splash=splash,
        air_drag=air_drag,
        planes=held,
        rate_max=float(np.sqrt(leg * by_legs + hardest * by_corners)),
    )


class Springs(NamedTuple):
    """Wire and legs as they are now.

    Attributes
    ----------
    stiffness, loss, stretch : float
        Of the wire [N/m], [s/m] and stretch under the weight [m].
    leg_loss, leg_stretch : float
        Of a leg.
    hook_inertia, hook_weight : float
        With the wire's share, see `payload.carried` [kg], [N].
    """

    stiffness: float
    loss: float
    stretch: float
    leg_loss: float
    leg_stretch: float
    hook_inertia: float
    hook_weight: float


@njit(cache=True)
def springs_at(wire: WireParams, load: RigidParams, length: float, slung: bool) -> Springs:
    """Return wire and legs at a paid-out length [m].

    Notes
    -----
    Damping is that of the whole load. The hook moves with at least the inertia with which micro steps of `STEP_MIN`
    resolve its vibration between wire and legs; it is less than a tenth of the load's, and the weight stays the hook's.
    """
    inertia, weight = carried(wire, length, load.hook_mass)
    hung, pulled = (inertia + load.mass, weight + load.mass * wire.gravity) if slung else (inertia, weight)
    stiffness, loss, stretch = hanging_wire(wire, length, hung, pulled)
    leg_stretch = 0.5 * load.mass * wire.gravity / load.leg_stiffness
    leg_loss = wire_loss(load.leg_stiffness, 0.5 * load.mass, wire.damping_ratio, 0.5 * load.mass * wire.gravity)
    if slung:
        springs = stiffness + 2.0 * load.leg_stiffness
        dashpots = stiffness * loss * stretch + 2.0 * load.leg_stiffness * leg_loss * leg_stretch
        inertia = max(inertia, least_mass(wire, springs, dashpots, STEP_MIN))
    return Springs(stiffness, loss, stretch, leg_loss, leg_stretch, inertia, weight)


@njit(cache=True)
def rigid_micro_steps(wire: WireParams, load: RigidParams, length: float, slung: bool, step_s: float) -> int:
    """Return how many micro steps resolve the vibrations of hook and load; at most about ``step_s / STEP_MIN``."""
    springs = springs_at(wire, load, length, slung)
    legs = 2.0 * load.leg_stiffness if slung else 0.0
    dashpots = springs.stiffness * springs.loss * springs.stretch + legs * springs.leg_loss * springs.leg_stretch
    hook = np.sqrt((springs.stiffness + legs) / springs.hook_inertia) / wire.phase_max
    damper = dashpots / springs.hook_inertia
    fastest = max(1.0 / step_s, hook, damper, load.rate_max / wire.phase_max, 1.0 / wire.micro_step_max)
    return int(np.ceil(step_s * fastest - 1e-9))


class Work(NamedTuple):
    """Arrays that `rigid_rate` fills, so that a step allocates them once.

    Attributes
    ----------
    force_w, moment_w, hook_force_w, part_w, added_mass, turning_w, lug : float64
        (3,) but the last, (6,).
    """

    force_w: Array
    moment_w: Array
    hook_force_w: Array
    part_w: Array
    added_mass: Array
    turning_w: Array
    lug: Array


@njit(cache=True)
def make_work() -> Work:
    """Return empty arrays."""
    return Work(np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(6))


@njit(cache=True)
def rigid_rate(
    wire: WireParams,
    load: RigidParams,
    springs: Springs,
    slung: bool,
    motion: Array,
    tip: Array,
    length: float,
    pay_out_rate: float,
    planes: Array,
    water: Array,
    wind: Array,
    work: Work,
    rate: Array,
) -> tuple[float, float, float]:
    """Fill the rate (19,) of hook and load, and return tension, normal force of contacts [N] and approach [m/s].

    Parameters
    ----------
    wire : WireParams
    load : RigidParams
    springs : Springs
    slung : bool
    motion : float64, shape (19,)
    tip : float64, shape (6,)
    length, pay_out_rate : float
        [m], [m/s].
    planes : float64, shape (n, 18)
        See `contact`.
    water : float64, shape (7,)
        See `splash.splash_load`.
    wind : float64, shape (3,)
        [m/s].
    work : Work
        ``hook_force_w`` and ``part_w`` hold the wire's force on the hook in the end.
    rate : float64, shape (19,)
    """
    force, moment, part, hook = work.force_w, work.moment_w, work.part_w, work.hook_force_w
    rot = matrix_from_quat(motion[QUAT:TURNING])
    place, velocity = motion[POSITION:VELOCITY], motion[VELOCITY:QUAT]
    for i in range(3):
        work.turning_w[i] = (
            rot[i, 0] * motion[TURNING] + rot[i, 1] * motion[TURNING + 1] + rot[i, 2] * motion[TURNING + 2]
        )
        force[i], moment[i], hook[i] = 0.0, 0.0, 0.0
    force[2] = -load.mass * wire.gravity
    turning = work.turning_w

    if slung:
        for leg in range(2):
            lug = load.lugs[leg]
            ax = rot[0, 0] * lug[0] + rot[0, 1] * lug[1] + rot[0, 2] * lug[2]
            ay = rot[1, 0] * lug[0] + rot[1, 1] * lug[1] + rot[1, 2] * lug[2]
            az = rot[2, 0] * lug[0] + rot[2, 1] * lug[1] + rot[2, 2] * lug[2]
            work.lug[0], work.lug[1], work.lug[2] = place[0] + ax, place[1] + ay, place[2] + az
            work.lug[3] = velocity[0] + turning[1] * az - turning[2] * ay
            work.lug[4] = velocity[1] + turning[2] * ax - turning[0] * az
            work.lug[5] = velocity[2] + turning[0] * ay - turning[1] * ax
            pull(
                motion[:6], work.lug, load.leg_length, 0.0, load.leg_stiffness, springs.leg_loss,
                springs.leg_stretch, part,
            )  # fmt: skip
            for i in range(3):
                force[i] += part[i]
                hook[i] -= part[i]
            moment[0] += ay * part[2] - az * part[1]
            moment[1] += az * part[0] - ax * part[2]
            moment[2] += ax * part[1] - ay * part[0]

    submerged = splash_load(load.splash, place, rot, velocity, turning, water, force, moment, work.added_mass)
    dry = load.air_drag * (1.0 - submerged)
    box_wind(load.splash.size, load.splash.centre, dry, rot, velocity, wind, force, moment)
    normal, approach = contact_load(
        planes, load.planes, load.corners, load.radius, place, rot, velocity, turning, force, moment
    )

    tension = pull(tip, motion[:6], length, pay_out_rate, springs.stiffness, springs.loss, springs.stretch, part)
    for i in range(3):
        rate[i] = motion[3 + i]
        rate[3 + i] = (hook[i] + part[i] - (springs.hook_weight if i == 2 else 0.0)) / springs.hook_inertia
        rate[POSITION + i] = velocity[i]
        rate[VELOCITY + i] = 0.0
    for k in range(3):
        along = rot[0, k] * force[0] + rot[1, k] * force[1] + rot[2, k] * force[2]
        along /= load.mass + work.added_mass[k]
        for i in range(3):
            rate[VELOCITY + i] += rot[i, k] * along
    qx, qy, qz, qw = quat_rate(motion[QUAT:TURNING], motion[TURNING : TURNING + 3])
    rate[QUAT], rate[QUAT + 1], rate[QUAT + 2], rate[QUAT + 3] = qx, qy, qz, qw
    for k in range(3):
        u, v = (k + 1) % 3, (k + 2) % 3
        about = rot[0, k] * moment[0] + rot[1, k] * moment[1] + rot[2, k] * moment[2]
        gyro = (load.inertia[v] - load.inertia[u]) * motion[TURNING + u] * motion[TURNING + v]
        rate[TURNING + k] = (about - gyro) / load.inertia[k]
    return tension, normal, approach
