"""The parametric hull: closed, with hydrostatics that known bodies have, and close to the real ship."""

import dataclasses
from collections import Counter
from itertools import pairwise
from math import gamma
from pathlib import Path

import numpy as np
import pytest

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.build import hull_hydrostatics, hull_mesh, read_hull
from shipcrane_twin.hydro.hull_form import half_breadth, section_points
from shipcrane_twin.hydro.mesh import hydrostatics, lid_panels
from test.hydro.imported_ships import SHIPX

HULL = Path(__file__).parents[2] / "config" / "vessels" / "gunnerus" / "hull.yaml"

VOLUME, KB, C33, C44, C55 = 493.472e3 / 1025.0, 1.591, 2.7320945e6, 7.9895465e6, 2.0532877e8
"""ShipX: displacement and VCB of vesselcoeff.xml, restoring matrix of retfun.re10."""
GM = C44 / (482026.94 * 9.81)
"""The same restoring matrix with the mass that stands beside it."""


@pytest.fixture(scope="module")
def config():
    return read_hull(HULL)


def grid_panels(nodes):
    """Return nodes and panels of a grid (a, b, 3), normals along d/da x d/db."""
    number = np.arange(nodes.shape[0] * nodes.shape[1]).reshape(nodes.shape[:2])
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    return nodes.reshape(-1, 3), np.stack(corners, axis=2).reshape(-1, 4)


def wigley(length, breadth, draught, along=80, down=40):
    x = np.linspace(-0.5 * length, 0.5 * length, along + 1)[:, None]
    z = np.linspace(0.0, -draught, down + 1)[None, :]
    y = 0.5 * breadth * (1.0 - (2.0 * x / length) ** 2) * (1.0 - (z / draught) ** 2)
    return grid_panels(np.stack(np.broadcast_arrays(x, y, z + draught), axis=2))


def test_hydrostatics_of_the_wigley_hull():
    length, breadth, draught, zg = 20.0, 4.0, 2.0, 1.7
    found = hydrostatics(*wigley(length, breadth, draught), draught, np.array([3.0, 0.0, zg]), 1000.0, 10.0)
    volume = 4.0 / 9.0 * length * breadth * draught
    plane = 2.0 / 3.0 * length * breadth
    kb = 0.625 * draught
    # int y^2 dA = 2/3 int y^3 dx = 2/3 (B/2)^3 L 16/35; int x^2 dA about midships = L^3 B / 30
    roll = 2.0 / 3.0 * (0.5 * breadth) ** 3 * length * 16.0 / 35.0
    pitch = length**3 * breadth / 30.0
    assert found.volume == pytest.approx(volume, rel=2e-3)
    assert found.waterplane_area == pytest.approx(plane, rel=1e-3)
    np.testing.assert_allclose(found.centre_of_buoyancy, [0.0, 0.0, kb], atol=2e-3)
    # the CoG stands 3 m ahead of the waterplane's centre: lifted by a positive (bow-down) pitch's opposite
    assert found.restoring[2, 4] == pytest.approx(1e4 * plane * 3.0, rel=1e-3)
    assert found.restoring[3, 3] == pytest.approx(1e4 * (roll + volume * (kb - zg)), rel=3e-3)
    assert found.restoring[4, 4] == pytest.approx(1e4 * (pitch + plane * 9.0 + volume * (kb - zg)), rel=3e-3)
    assert found.metacentric_height == pytest.approx(roll / volume + kb - zg, rel=3e-3)


def test_panels_that_enclose_no_water_or_stand_above_it_are_refused():
    points, panels = wigley(20.0, 4.0, 2.0)
    cog = np.array([0.0, 0.0, 1.0])
    with pytest.raises(ConfigError, match="normals into the water"):
        hydrostatics(points, panels[:, ::-1], 2.0, cog, 1000.0, 10.0)
    with pytest.raises(ConfigError, match="cut it at the draught"):
        hydrostatics(points, panels, 1.5, cog, 1000.0, 10.0)


@pytest.mark.parametrize("exponent", [1.0, 1.6, 2.0, 3.8])
def test_a_section_has_the_area_of_a_superellipse_and_ends_at_the_inner_breadth(exponent):
    y, d = section_points(4.8, 2.6, exponent, 0.0, 400).T
    area = 4.8 * 2.6 * gamma(1.0 + 1.0 / exponent) ** 2 / gamma(1.0 + 2.0 / exponent)
    assert np.trapezoid(y, d) == pytest.approx(area, rel=1e-3)
    inner = section_points(4.8, 2.6, exponent, 0.2, 16)
    assert inner[0] == pytest.approx([4.8, 0.0])
    assert inner[-1, 0] == pytest.approx(0.2)
    assert (inner[-1, 1] / 2.6) ** exponent + (0.2 / 4.8) ** exponent == pytest.approx(1.0)


def nodes_between(nodes, a, b):
    """Return an edge as a chain of nodes: a long straight edge may meet several short ones."""
    length = np.linalg.norm(b - a)
    share = (nodes - a) @ (b - a) / length**2
    off = np.linalg.norm(nodes - a - np.clip(share, 0.0, 1.0)[:, None] * (b - a), axis=1)
    on = np.flatnonzero(off < 2e-5)
    return [tuple(nodes[n].tolist()) for n in on[np.argsort(share[on])]]


def test_hull_and_lid_are_closed_and_face_the_water(config):
    points, panels = hull_mesh(config)
    lid, water = lid_panels(config.form, config.skeg, config.mesh, config.draught_m)
    nodes = np.unique(np.round(np.concatenate([points, lid]), 5), axis=0)
    edges = Counter()
    for corners, faces in ((points, panels), (lid, water[:, ::-1])):  # the lid closes the hull with its back
        for face in faces:
            ring = np.round(corners[list(dict.fromkeys(face.tolist()))], 5)
            for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                parts = nodes_between(nodes, a, b)
                edges.update(pairwise(parts))
    for (a, b), count in edges.items():
        on_centre_line = a[1] == 0.0 and b[1] == 0.0
        assert on_centre_line or edges[b, a] == count, f"edge {a} {b} is open"
    assert 700 <= len(panels) <= 1200
    assert points[:, 2].max() == pytest.approx(config.draught_m)


def test_close_to_the_real_ship(config, measured):
    found = hull_hydrostatics(config)
    for name, value, reference, bar in (
        ("volume", found.volume, VOLUME, 0.01),
        ("C33", found.restoring[2, 2], C33, 0.01),
        ("C44", found.restoring[3, 3], C44, 0.01),
        ("C55", found.restoring[4, 4], C55, 0.01),
        ("KB", found.centre_of_buoyancy[2], KB, 0.02),
        ("GM_T", found.metacentric_height, GM, 0.02),
    ):
        measured(f"hull: {name} against ShipX", 100.0 * abs(value / reference - 1.0), 100.0 * bar, "%")
    assert found.centre_of_buoyancy[0] == pytest.approx(config.cog_m[0], abs=0.002)  # floats on even keel


@pytest.mark.skipif(not SHIPX.is_file(), reason="the reference data are not on this machine")
def test_waterline_follows_the_real_one(config):
    import zipfile

    with zipfile.ZipFile(SHIPX) as archive:
        name = next(name for name in archive.namelist() if name.endswith("waterline.asc"))
        rows = np.loadtxt(archive.read(name).decode().splitlines(), skiprows=2)
    port = rows[1 : len(rows) // 2]
    error = half_breadth(config.form, port[:, 0]) - port[:, 1]
    assert np.sqrt((error**2).mean()) < 0.15
    assert np.abs(error).max() < 0.3


def test_every_parameter_moves_the_mesh(config):
    points = hull_mesh(config)[0]
    for group in ("form", "skeg", "mesh"):
        part = getattr(config, group)
        for field in dataclasses.fields(part):
            if field.name == "lid":
                continue  # the lid is another mesh
            value = getattr(part, field.name)
            other = value + 1 if isinstance(value, int) else 0.95 * value
            changed = dataclasses.replace(config, **{group: dataclasses.replace(part, **{field.name: other})})
            moved = hull_mesh(changed)[0]
            assert moved.shape != points.shape or np.abs(moved - points).max() > 1e-3, f"{group}.{field.name}"


@pytest.mark.parametrize(
    ("key", "value", "match"),
    [
        ("bow_x_m: 34.146", "bow_x_m: -2.0", r"form.bow_x_m is -2, expected ahead of form.stern_x_m"),
        ("run_x_m: 17.138", "run_x_m: 27.0", r"form.forefoot_x_m is 25.203, expected not aft of form.run_x_m = 27"),
        ("run_x_m: 17.138", "run_x_m: 40.0", r"form.run_x_m is 40, expected between form.stern_x_m"),
        ("transom_breadth_m: 7.918", "transom_breadth_m: 10.0", "expected at most form.breadth_m = 9.6"),
        ("transom_draught_m: 0.466", "transom_draught_m: 2.7", "form.transom_draught_m is 2.7, expected below 2.6"),
        ("  draught_m: 3.1 ", "  draught_m: 3.2 ", r"skeg.draught_m is 3.2, expected at most 3.1"),
        ("fore_x_m: 15.0", "fore_x_m: 0.1", r"skeg.fore_x_m is 0.1, expected ahead of skeg.aft_x_m"),
        ("[15.516, 0.0, 3.624]", "[15.516, 0.4, 3.624]", r"cog_m\[1\] is 0.4, expected 0"),
        ("length_m", "length_mm", "unit clash: this setting is length_m"),
        ("direction_step_deg: 5", "direction_step_deg: 7", "a divisor of 180"),
        ("[0.1, 0.2,", "[0.2, 0.1,", "rising values"),
    ],
)
def test_a_wrong_parameter_is_named_with_its_remedy(tmp_path, key, value, match):
    text = HULL.read_text()
    assert key in text
    path = tmp_path / "hull.yaml"
    path.write_text(text.replace(key, value, 1))
    with pytest.raises(ConfigError, match=match) as caught:
        read_hull(path)
    assert str(path) in str(caught.value)
