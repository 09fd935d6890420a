"""A box through the splash zone at constant speed, against a hand calculation after DNV-RP-N103."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from shipcrane_twin.hydro.compare import Row
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.splash import SplashParams, body_added_mass, splash_load

SIZE = np.array([4.0, 3.0, 2.0])
DENSITY, GRAVITY = 1025.0, 9.80665
DRAG, SLAMMING = 1.2, 5.0
STILL = np.zeros(7)
AREA = 12.0
"""Of the bottom, 4 m by 3 m [m2]."""

FULL_ADDED_KG = 1.462 * 1025.0 * 0.658 * np.pi / 4.0 * 3.0**2 * 4.0
"""By hand: plate of aspect 1.333, coefficient 0.658 between 0.642 and 0.690; a box 2 m high has 1.462 of it
(lambda = sqrt(12) / (2 + sqrt(12)) = 0.634, factor 1 + sqrt(0.598 / 2.804))."""

SPEED_M_S = 0.5
EASED_M = 0.05
"""About the depths where slamming begins and ends, which it does softly here and at once in the hand calculation."""

BAR = 0.02


def box_in_water(size: Array = SIZE, centre: ArrayLike = (0.0, 0.0, 0.0), **changes: Any) -> SplashParams:
    """Return a closed box of a size (3,) [m], whose middle is at a place (3,) seen from its CoG."""
    added = [body_added_mass(size[k - 2], size[k - 1], size[k], DENSITY, 0.0) for k in range(3)]
    box = SplashParams(
        np.array(size, float), np.array(centre, float), 1.0, DENSITY, GRAVITY, DRAG, SLAMMING, np.array(added)
    )
    return box._replace(**changes)


def load_at(
    depth: float,
    velocity: ArrayLike = (0.0, 0.0, 0.0),
    water: Array = STILL,
    rot: Array | None = None,
    box: SplashParams | None = None,
    turning: ArrayLike = (0.0, 0.0, 0.0),
) -> tuple[Array, Array, Array]:
    """Return force, moment and added mass, (3,) each, with the bottom of the upright box at a depth [m]."""
    force, moment, added = np.zeros(3), np.zeros(3), np.full(3, np.nan)
    box = box_in_water() if box is None else box
    place = np.array([0.0, 0.0, water[0] - depth + 0.5 * box.size[2]])
    rot = np.eye(3) if rot is None else rot
    splash_load(box, place, rot, np.array(velocity), np.array(turning), water, force, moment, added)
    return force, moment, added


class Transit(NamedTuple):
    """Forces on a box on its way down, float64 (n,): depth of its bottom [m], forces up [N], added mass [kg].

    ``by_hand`` is the sum of ``buoyancy``, ``drag`` and ``slamming``.
    """

    depth: Array
    force: Array
    added_mass: Array
    buoyancy: Array
    drag: Array
    slamming: Array
    added_by_hand: Array

    @property
    def by_hand(self) -> Array:
        """Sum of the terms [N]."""
        return self.buoyancy + self.drag + self.slamming

    @property
    def force_error(self) -> float:
        """Largest relative error of the force, away from where slamming begins and ends."""
        ends = self.depth[np.flatnonzero(np.diff(self.slamming) != 0.0)]
        far = self.depth > EASED_M
        for end in ends:
            far &= np.abs(self.depth - end) > EASED_M
        return float(np.abs(self.force / self.by_hand - 1.0)[far].max())

    @property
    def added_error(self) -> float:
        """Largest error of the added mass over that of the submerged box."""
        return float(np.abs(self.added_mass - self.added_by_hand).max() / self.added_by_hand.max())


def transit(speed: float = SPEED_M_S) -> Transit:
    """Lower the box through still water at a speed [m/s]; the terms of RP-N103 beside it by hand."""
    depth = np.linspace(0.0, 4.0, 401)
    found = [load_at(d, (0.0, 0.0, -speed)) for d in depth]
    grown = np.minimum(0.5 * DENSITY * SLAMMING * AREA * depth, FULL_ADDED_KG)
    return Transit(
        depth,
        np.array([force[2] for force, _, _ in found]),
        np.array([added[2] for _, _, added in found]),
        DENSITY * GRAVITY * AREA * np.minimum(depth, SIZE[2]),
        np.full_like(depth, 0.5 * DENSITY * DRAG * AREA * speed**2),
        np.where(grown < FULL_ADDED_KG, 0.5 * DENSITY * SLAMMING * AREA * speed**2, 0.0),
        grown,
    )


def splash_rows(found: Transit) -> list[Row]:
    """Return how far force and added mass are from the hand calculation."""
    most = found.by_hand.max() / 1e3
    return [
        Row("box lowered through the surface at 0.5 m/s: force", found.force_error, BAR, "", f"at most {most:.0f} kN"),
        Row(
            "box lowered through the surface: added mass", found.added_error, BAR, "",
            f"{FULL_ADDED_KG / 1e3:.1f} t submerged",
        ),
    ]  # fmt: skip
