"""The Palfinger crane and a six-joint stranger, for tests; numbers from the reference data of the crane."""

from math import atan, hypot, pi

import numpy as np

from shipcrane_twin.physics.crane_actuators import ActuatorParams
from shipcrane_twin.physics.crane_chain import ChainParams, make_chain
from shipcrane_twin.physics.crane_cylinders import DriveParams, LinearDrive, TriangleDrive, make_drives
from shipcrane_twin.physics.crane_reference import MotionLimits, make_limits
from shipcrane_twin.physics.crane_segments import Segment

GRAVITY = 9.80665
UP = np.array([0.0, 0.0, GRAVITY])  # proper acceleration of a base at rest
WORK_POSE = np.array([-pi / 2, 0.5, 0.9, 2.0])


def palfinger_chain(**telescope) -> ChainParams:
    """The published crane, its telescope one body unless told otherwise."""
    links = dict(
        dh=[
            [0.0, 0.0, 2.0, 0.0],
            [-0.38, pi / 2, 0.0, 0.0],
            [1.85, 0.0, -0.6, 0.0],
            [0.0, pi / 2, 0.0, 0.0],
            [-0.5, 0.0, 2.0, 0.0],
        ],
        kind=["revolute", "revolute", "revolute", "prismatic"],
        mass=[1524.0, 2236.0, 1264.0, 1000.0],
        cog=[[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [-0.5, -1.0, 0.0], [-0.5, 0.0, 1.0]],
        inertia=[
            np.diag(diagonal)
            for diagonal in (
                [1178.0, 1265.0, 328.0],
                [371.0, 7971.0, 7995.0],
                [3114.0, 129.0, 3162.0],
                [3000.0, 3000.0, 100.0],
            )
        ],
    )
    return make_chain(**(links | telescope))


SEGMENT_MASSES = (190.0, 170.0, 150.0, 135.0, 115.0, 95.0, 80.0, 65.0)


def eight_segment_chain() -> ChainParams:
    """The same crane with eight telescope segments of 1.25 m stroke that together weigh as much."""
    plain = palfinger_chain()
    bars = [np.diag([m / 3.0, m / 3.0, 0.1 * m]) for m in SEGMENT_MASSES]
    return palfinger_chain(
        mass=[*plain.mass[:3], SEGMENT_MASSES[-1]],
        inertia=[*plain.inertia[:3], bars[-1]],
        segments={
            3: [Segment(m, [-0.5, 0.0, 1.0], bar, 1.25) for m, bar in zip(SEGMENT_MASSES[:-1], bars, strict=False)]
        },
        handover=0.1,
    )


def palfinger_drives() -> DriveParams:
    return make_drives(
        [
            LinearDrive(),
            TriangleDrive(hypot(1.4, 0.5), 0.5, atan(0.5 / 1.4) - pi / 2, 1.1, 1.8),
            TriangleDrive(1.55, hypot(0.34, 0.36), -atan(0.36 / 0.34) - atan(0.4 / 1.55), 1.2, 1.9),
            LinearDrive(offset=-1.5, length_min=1.5, length_max=11.5),
        ]
    )


def palfinger_limits() -> MotionLimits:
    return make_limits(
        palfinger_drives(),
        rate_max=[0.05, 0.01, 0.01, 0.05],
        accel_max=[0.025, 0.008, 0.008, 0.05],
        jerk_max=[0.1, 0.04, 0.04, 0.25],
        end_margin=0.01,
    )


def palfinger_actuators(**changes) -> ActuatorParams:
    """Oil columns of 2 to 8 Hz in a working posture, strong enough for anything."""
    stiffness = np.array([1.6e7, 1.7e8, 4.0e7, 2.6e6])
    plain = ActuatorParams(
        stiffness=stiffness,
        damping=stiffness * np.array([0.11, 0.075, 0.055, 0.028]),
        push=np.full(4, np.inf),
        pull=np.full(4, np.inf),
        hold_push=np.full(4, np.inf),
        hold_pull=np.full(4, np.inf),
        friction=np.array([1.0e4, 8.0e4, 8.0e4, 500.0]),
        leak_push=np.array([1e-8, 1e-9, 1e-9, 1e-8]),
        leak_pull=np.array([1e-8, 2e-9, 2e-9, 2e-8]),
        tracking=2.0,
    )
    return plain._replace(**changes)


def mixed_chain(**more) -> ChainParams:
    """Six mixed joints, skew axes, full inertia tensors, a turned tip: nothing cancels by symmetry."""
    rng = np.random.default_rng(11)
    rows = np.column_stack(
        (
            rng.uniform(-1.0, 1.0, 7),
            rng.uniform(-pi, pi, 7),
            rng.uniform(-1.0, 1.0, 7),
            rng.uniform(-pi, pi, 7),
        )
    )
    kind = ["prismatic", "revolute", "revolute", "prismatic", "revolute", "revolute"]
    tensors = []
    for _ in kind:
        points = rng.normal(size=(8, 3))  # a cloud of point masses is a possible body
        tensors.append(30.0 * (np.sum(points**2) * np.eye(3) - points.T @ points))
    return make_chain(
        dh=rows, kind=kind, mass=rng.uniform(50.0, 900.0, 6), cog=rng.normal(size=(6, 3)), inertia=tensors, **more
    )


def mixed_telescopes() -> ChainParams:
    """The stranger with three skew segments behind each prismatic joint."""
    rng = np.random.default_rng(13)

    def skew_segments():
        for _ in range(3):
            points = rng.normal(size=(8, 3))
            tensor = 5.0 * (np.sum(points**2) * np.eye(3) - points.T @ points)
            yield Segment(rng.uniform(50.0, 300.0), rng.normal(size=3), tensor, rng.uniform(0.4, 0.6))

    return mixed_chain(segments={0: list(skew_segments()), 3: list(skew_segments())}, handover=0.4)


def random_vectors(rng, count: int, size: float = 1.0) -> list[np.ndarray]:
    return [rng.normal(size=3) * size for _ in range(count)]


def inertia_tensor(row: np.ndarray) -> np.ndarray:
    """Write xx, xy, xz, yy, yz, zz as a matrix."""
    xx, xy, xz, yy, yz, zz = row
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
