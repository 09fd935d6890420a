"""Databases: what no ship can have is refused, files keep every number, another CoG is the same ship."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from imported_ships import COG, RHO, G, a_ship, box_loads, mass_of
from scipy.io import netcdf_file

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.database import HydroDatabase, RadiationFit, check, moved
from shipcrane_twin.hydro.files import load_database, save_database
from shipcrane_twin.hydro.rao import raos

GUNNERUS = Path(__file__).parents[2] / "config" / "vessels" / "gunnerus" / "hydro.nc"


def fitted(data):
    """The ship with a state-space model of no meaning but full rank."""
    seed = np.random.default_rng(5)
    half = seed.normal(size=(2, 3, 3, 4, 2))
    fit = RadiationFit(
        a=np.tile([[-0.4, 1.1], [-1.1, -0.4]], (2, 4, 1, 1)) * np.arange(1.0, 5.0)[:, None, None],
        b=seed.normal(size=(2, 4, 2)),
        c=1e5 * (half + np.swapaxes(half, 1, 2)),
    )
    return dataclasses.replace(data, fit=fit)


def altered(data, **changes):
    return dataclasses.replace(data, **{name: change(getattr(data, name)) for name, change in changes.items()})


def lopsided(values):
    out = values.copy()
    out[..., 0, 4] += 0.2 * np.sqrt(np.abs(out[..., 0, 0] * out[..., 4, 4]).max())
    return out


WRONG = {
    "negative volume": ({"volume": lambda v: -v}, r"volume is -1200, expected a positive number"),
    "no depth": ({"depth": lambda v: 0.0}, r"depth is 0, expected a positive number"),
    "load in kN": ({"excitation": lambda v: 1e3 * v}, r"heave load in long waves is .* times C33, .*SI units \(N/m\)"),
    "mass in tonnes": ({"added_mass_inf": lambda v: 1e-3 * v}, r"A33 is .* times the ship's mass, expected SI units"),
    "stiffness in kN/m": (
        {"restoring": lambda v: 1e-3 * v},
        r"makes a waterplane of .* expected SI units \(N/m, m3, m\)",
    ),
    "asymmetric added mass": ({"added_mass": lopsided}, r"added_mass is asymmetric by .* %.*within 3 %"),
    "asymmetric damping": ({"damping": lopsided}, r"damping is asymmetric"),
    "frequency in Hz, falling": ({"omega": lambda v: v[::-1]}, r"40 frequencies are not positive and rising"),
    "directions to 150 degrees": (
        {"direction": lambda v: v[:-2], "excitation": lambda v: v[:, :-2], "drift": lambda v: v[:, :-2]},
        r"wave directions are \[ *0.*150\.\] degrees, expected rising from 0 to 180 degrees",
    ),
    "a gap in the directions": (
        {
            "direction": lambda v: np.delete(v, [4, 5]),
            "excitation": lambda v: np.delete(v, [4, 5], axis=1),
            "drift": lambda v: np.delete(v, [4, 5], axis=1),
        },
        r"without a gap above 30 degrees",
    ),
    "directions in degrees": ({"direction": np.rad2deg}, r"expected rising from 0 to 180 degrees"),
    "a load that is no number": ({"excitation": lambda v: v * np.nan}, r"excitation holds numbers that are not finite"),
    "a table too short": ({"drift": lambda v: v[:-1]}, r"drift has the shape \(39, 13, 3\), expected \(40, 13, 3\)"),
    "panels without points": ({"panels": lambda v: np.array([[0, 1, 2, 3]], np.int32)}, r"beyond its 0 points"),
}


@pytest.mark.parametrize(("changes", "match"), WRONG.values(), ids=WRONG.keys())
def test_what_no_ship_can_have_is_named(changes, match):
    with pytest.raises(ConfigError, match=match) as caught:
        check(altered(a_ship(), **changes), "ship.nc")
    assert str(caught.value).startswith("ship.nc: ")


def test_a_wrong_database_is_not_written(tmp_path):
    with pytest.raises(ConfigError, match=r"ship.nc: volume is -1200"):
        save_database(tmp_path / "ship.nc", altered(a_ship(), volume=lambda v: -v))
    assert list(tmp_path.iterdir()) == []


def with_mesh(data):
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]])
    return dataclasses.replace(data, points=points, panels=np.array([[0, 1, 2, 3], [0, 1, 2, 2]], np.int32))


@pytest.mark.parametrize("source", [lambda: with_mesh(fitted(a_ship())), lambda: load_database(GUNNERUS)])
def test_a_file_keeps_every_number(tmp_path, source):
    data = source()
    save_database(tmp_path / "ship.nc", data)
    back = load_database(tmp_path / "ship.nc")
    for field in dataclasses.fields(HydroDatabase):
        if field.name != "fit":
            np.testing.assert_array_equal(getattr(back, field.name), getattr(data, field.name), err_msg=field.name)
    for name in ("a", "b", "c"):
        np.testing.assert_array_equal(getattr(back.fit, name), getattr(data.fit, name))
    assert [path.name for path in tmp_path.iterdir()] == ["ship.nc"]


def test_files_that_are_none_are_refused_with_a_remedy(tmp_path):
    path = tmp_path / "ship.nc"
    with pytest.raises(ConfigError, match=r"ship.nc: no such file; give the path"):
        load_database(path)
    path.write_bytes(b"not a database at all")
    with pytest.raises(ConfigError, match=r"ship.nc: cannot be read as .*; build or import it again"):
        load_database(path)
    with netcdf_file(path, "w") as file:
        file.title = "another one's"
    with pytest.raises(ConfigError, match=r"ship.nc: not a .*`shipcrane hydro build` or `hydro import`"):
        load_database(path)


@pytest.mark.parametrize("share", [0.2, 0.6, 0.95])
def test_a_file_cut_short_is_refused(tmp_path, share):
    whole = GUNNERUS.read_bytes()
    path = tmp_path / "ship.nc"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ConfigError, match=r"ship.nc: "):
        load_database(path)


def test_a_file_that_lacks_a_variable_is_refused(tmp_path):
    path = tmp_path / "ship.nc"
    path.write_bytes(GUNNERUS.read_bytes().replace(b"added_mass_inf", b"added_mass_fin"))
    with pytest.raises(ConfigError, match=r"ship.nc: cannot be read as .*added_mass_inf.*build or import it again"):
        load_database(path)


ARM = np.array([-1.3, 0.0, 0.7])


def carried(mass6, arm):
    """The same rigid body's mass about a point that lies at `arm` from the first one."""
    x, y, z = arm
    shift = np.eye(6)
    shift[:3, 3:] = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])  # v_old = v_new + omega x (-arm)
    return shift.T @ mass6 @ shift, shift


def test_about_another_point_the_same_ship_moves_alike():
    """The body's mass moves along; what the CoG of before does is the same, seen from the new point."""
    data = fitted(a_ship())
    about = moved(data, data.cog + ARM)
    mass6, shift = carried(mass_of(data), ARM)
    # weight restores about each database's own CoG, this body keeps its weight where it was
    about.restoring[3, 3] += data.mass * G * ARM[2]
    about.restoring[4, 4] += data.mass * G * ARM[2]
    number = data.omega**2 / data.gravity
    phase = np.exp(1j * number[:, None] * np.cos(data.direction) * ARM[0])[..., None]
    for from_fit in (False, True):
        here, there = raos(data, mass_of(data), from_fit=from_fit), raos(about, mass6, from_fit=from_fit)
        seen = (there / phase) @ shift.T
        np.testing.assert_allclose(seen, here, atol=1e-9 * np.abs(here).max())


def test_loads_about_another_point_are_the_box_pressure_about_it():
    """The quadrature of the box's loads knows nothing of `moved`; here its CoG is elsewhere in the same box."""
    data = a_ship()
    about = moved(data, COG + [0.0, 0.0, 0.5])
    loads = np.array([[box_loads(w, d) for d in data.direction] for w in data.omega])
    lowered = loads.copy()
    lowered[..., 3] += 0.5 * loads[..., 1]
    lowered[..., 4] -= 0.5 * loads[..., 0]
    np.testing.assert_allclose(about.excitation, lowered, rtol=1e-12, atol=1e-6)


def test_restoring_follows_the_weight():
    """Rise of the CoG by z: GM falls by z; a step forward: the waterplane lies further aft of it."""
    data = a_ship()
    about = moved(data, data.cog + ARM)
    weight = RHO * G * data.volume
    assert about.restoring[3, 3] == pytest.approx(data.restoring[3, 3] - weight * ARM[2])
    assert about.restoring[2, 4] == pytest.approx(data.restoring[2, 4] + data.restoring[2, 2] * ARM[0])
    c33, c35 = data.restoring[2, 2], data.restoring[2, 4]
    expected = data.restoring[4, 4] + 2.0 * c35 * ARM[0] + c33 * ARM[0] ** 2 - weight * ARM[2]
    assert about.restoring[4, 4] == pytest.approx(expected)


def test_there_and_back_is_the_same_database():
    data = fitted(a_ship())
    back = moved(moved(data, data.cog + ARM), data.cog)
    for name in ("restoring", "added_mass", "damping", "added_mass_inf", "excitation", "drift"):
        was = getattr(data, name)
        np.testing.assert_allclose(getattr(back, name), was, rtol=1e-9, atol=1e-9 * np.abs(was).max(), err_msg=name)
    np.testing.assert_allclose(back.fit.c, data.fit.c, atol=1e-9 * np.abs(data.fit.c).max())
    assert moved(data, data.cog) is data


def test_drift_turns_about_the_new_point():
    data = a_ship()
    about = moved(data, data.cog + ARM)
    np.testing.assert_allclose(about.drift[..., :2], data.drift[..., :2])
    np.testing.assert_allclose(about.drift[..., 2], data.drift[..., 2] - ARM[0] * data.drift[..., 1])


def test_a_centre_of_gravity_off_the_centre_line_is_refused():
    data = a_ship()
    with pytest.raises(ConfigError, match=r"the CoG is 0.2 m off the centre line"):
        moved(data, data.cog + [0.0, 0.2, 0.0])
