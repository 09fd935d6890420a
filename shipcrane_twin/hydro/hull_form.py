"""A ship's hull from a few parameters: superellipse sections between two profiles, and a skeg."""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le

from shipcrane_twin.config.settings import ConfigError, Number, Whole, settings
from shipcrane_twin.physics.arrays import Array

Positive = Annotated[Number, Gt(0)]
Power = Annotated[Number, Ge(0.3), Le(12)]
Exponent = Annotated[Number, Ge(0.8), Le(12)]

COLUMNS = 3
"""Panels across half the transom."""


@settings
class HullFormConfig:
    """Hull below still water, positions from the aft perpendicular, forward.

    The waterline runs from the transom to full breadth at `aft_shoulder_x_m`, and from `fore_shoulder_x_m` to the
    stem; the keel, deeper aft by `keel_rake_m` from end to end, rises to the transom from `run_x_m` and to the stem
    from `forefoot_x_m`. A section is
    ``(y / b)^n + (d / T)^n = 1`` with its own half breadth b, draught T and exponent n: 1 a triangle, 2 an ellipse,
    above that a box. The exponent is one along the middle body and blends to its end values.
    """

    breadth_m: Positive
    stern_x_m: Number
    bow_x_m: Number
    aft_shoulder_x_m: Number
    fore_shoulder_x_m: Number
    transom_breadth_m: Positive
    counter_power: Power
    entrance_power: Power
    entrance_fullness: Power
    transom_draught_m: Positive
    keel_rake_m: Annotated[Number, Ge(-3), Le(3)]
    run_x_m: Number
    run_power: Power
    forefoot_x_m: Number
    forefoot_power: Power
    section_exponent_aft: Exponent
    section_exponent_mid: Exponent
    section_exponent_fore: Exponent


@settings
class SkegConfig:
    """A box on the centre line under the rising keel, from aft to fore end, down to `draught_m`."""

    aft_x_m: Number
    fore_x_m: Number
    draught_m: Positive
    breadth_m: Positive


@settings
class MeshConfig:
    """Panels on the port half: along the ship, from waterline to keel, down the skeg; across the lid inside."""

    along: Annotated[Whole, Ge(8), Le(200)]
    girth: Annotated[Whole, Ge(4), Le(60)]
    skeg: Annotated[Whole, Ge(1), Le(10)]
    lid: Annotated[Whole, Ge(1), Le(20)]


def check_form(form: HullFormConfig, skeg: SkegConfig, draught: float, where: str) -> None:
    """Raise ConfigError, naming key and remedy, where the parameters do not describe a hull."""

    def demand(holds: bool, key: str, value: float, expected: str) -> None:
        if not holds:
            raise ConfigError(f"{where}: {key} is {value:g}, expected {expected}")

    f = form
    demand(f.bow_x_m > f.stern_x_m, "form.bow_x_m", f.bow_x_m, f"ahead of form.stern_x_m = {f.stern_x_m:g}")
    for key in ("aft_shoulder_x_m", "fore_shoulder_x_m", "run_x_m", "forefoot_x_m"):
        value = getattr(f, key)
        between = f"between form.stern_x_m = {f.stern_x_m:g} and form.bow_x_m = {f.bow_x_m:g}"
        demand(f.stern_x_m < value < f.bow_x_m, f"form.{key}", value, between)
    for aft, fore in (("aft_shoulder_x_m", "fore_shoulder_x_m"), ("run_x_m", "forefoot_x_m")):
        value = getattr(f, fore)
        demand(value >= getattr(f, aft), f"form.{fore}", value, f"not aft of form.{aft} = {getattr(f, aft):g}")
    widest = f"at most form.breadth_m = {f.breadth_m:g}"
    demand(f.transom_breadth_m <= f.breadth_m, "form.transom_breadth_m", f.transom_breadth_m, widest)
    demand(f.transom_draught_m < draught, "form.transom_draught_m", f.transom_draught_m, f"below {draught:g}")
    deepest = draught + 0.5 * abs(form.keel_rake_m)
    demand(skeg.draught_m <= deepest, "skeg.draught_m", skeg.draught_m, f"at most {deepest:g}, the raked keel's")
    demand(skeg.fore_x_m > skeg.aft_x_m, "skeg.fore_x_m", skeg.fore_x_m, f"ahead of skeg.aft_x_m = {skeg.aft_x_m:g}")
    demand(skeg.fore_x_m < f.bow_x_m, "skeg.fore_x_m", skeg.fore_x_m, f"aft of form.bow_x_m = {f.bow_x_m:g}")
    demand(skeg.aft_x_m > f.stern_x_m, "skeg.aft_x_m", skeg.aft_x_m, f"ahead of form.stern_x_m = {f.stern_x_m:g}")
    narrow = 0.5 * f.transom_breadth_m
    demand(skeg.breadth_m < narrow, "skeg.breadth_m", skeg.breadth_m, f"below half the transom, {narrow:g}")


def half_breadth(form: HullFormConfig, x: Array) -> Array:
    """Return the half breadth of the waterline [m] at stations (n,) from the aft perpendicular [m]."""
    aft = np.clip((form.aft_shoulder_x_m - x) / (form.aft_shoulder_x_m - form.stern_x_m), 0.0, 1.0)
    fore = np.clip((x - form.fore_shoulder_x_m) / (form.bow_x_m - form.fore_shoulder_x_m), 0.0, 1.0)
    full = 0.5 * form.breadth_m
    narrowing = (full - 0.5 * form.transom_breadth_m) * aft**form.counter_power
    return (full - narrowing) * (1.0 - fore**form.entrance_power) ** form.entrance_fullness


def keel_depth(form: HullFormConfig, draught: float, x: Array) -> Array:
    """Return the depth of the keel below still water [m], without the skeg, at stations (n,)."""
    aft = np.clip((form.run_x_m - x) / (form.run_x_m - form.stern_x_m), 0.0, 1.0)
    fore = np.clip((x - form.forefoot_x_m) / (form.bow_x_m - form.forefoot_x_m), 0.0, 1.0)
    share = (x - form.stern_x_m) / (form.bow_x_m - form.stern_x_m)
    keel = draught + form.keel_rake_m * (0.5 - share)
    return (keel - (keel - form.transom_draught_m) * aft**form.run_power) * (1.0 - fore**form.forefoot_power)


def section_exponent(form: HullFormConfig, x: Array) -> Array:
    """Return the exponent of the sections at stations (n,)."""
    aft = np.clip((form.run_x_m - x) / (form.run_x_m - form.stern_x_m), 0.0, 1.0)
    fore = np.clip((x - form.fore_shoulder_x_m) / (form.bow_x_m - form.fore_shoulder_x_m), 0.0, 1.0)
    mid = form.section_exponent_mid
    # squared sines leave the middle body and reach the ends without a kink
    return (
        mid
        + (form.section_exponent_aft - mid) * np.sin(0.5 * np.pi * aft) ** 2
        + (form.section_exponent_fore - mid) * np.sin(0.5 * np.pi * fore) ** 2
    )


def section_points(breadth: float, depth: float, exponent: float, inner: float, count: int) -> Array:
    """Return points (count + 1, 2) of y and depth [m] along a section, from the waterline to ``y = inner``.

    Parameters
    ----------
    breadth, depth, exponent : float
        Half breadth and draught [m] of a superellipse, and its exponent.
    inner : float
        Half breadth [m] at which to end.
    count : int
        Panels, equal along the arc but shorter by half towards the waterline, where waves act.
    """
    if breadth <= 0.0 or depth <= 0.0:
        return np.stack([np.full(count + 1, inner), np.zeros(count + 1)], axis=1)
    last = np.arccos(min(inner / breadth, 1.0) ** (0.5 * exponent))
    # the power law leaves the ends in a vanishing step unless the angles crowd there
    angle = last * (0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 2001)))
    y = breadth * np.cos(angle) ** (2.0 / exponent)
    d = depth * np.sin(angle) ** (2.0 / exponent)
    y[-1] = min(inner, breadth)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(d)))])
    share = np.linspace(0.0, 1.0, count + 1)
    wanted = arc[-1] * (share + 0.25 * share * (share - 1.0) * 2.0)
    return np.stack([np.interp(wanted, arc, y), np.interp(wanted, arc, d)], axis=1)
