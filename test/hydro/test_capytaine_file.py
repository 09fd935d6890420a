"""Capytaine itself writes the files: its NetCDF, and the WAMIT files of its own exporter as a second witness."""

import logging

import numpy as np
import pytest
from imported_ships import without_fit

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.hydro.capytaine_file import import_capytaine
from shipcrane_twin.hydro.importing import Particulars
from shipcrane_twin.hydro.wamit import import_wamit

OMEGA = np.array([0.2, 0.45, 0.7, 0.95, 1.2, 1.45, 1.7, 2.0])  # below the first irregular frequency
COG = np.array([12.0, 0.0, 2.5])  # from aft perpendicular, centre line, baseline
DRAUGHT, LENGTH, BEAM = 2.0, 20.0, 6.0
MIDSHIP = 11.0
VOLUME = np.pi / 6 * LENGTH * BEAM * DRAUGHT
KB = 5 / 8 * DRAUGHT


def solved(x_origin, centre):
    """Solve half an ellipsoid; its mesh has its zero at x_origin from the aft perpendicular."""
    cpt = pytest.importorskip("capytaine")
    pytest.importorskip("netCDF4")
    logging.getLogger("capytaine").setLevel(logging.ERROR)
    ball = cpt.mesh_sphere(radius=1.0, resolution=(30, 20))
    stretched = ball.vertices[:, [2, 1, 0]] * [-LENGTH / 2, BEAM / 2, DRAUGHT]  # poles at bow and stern
    mesh = cpt.Mesh(vertices=stretched + [MIDSHIP - x_origin, 0.0, 0.0], faces=ball.faces)
    cog = COG - [x_origin, 0.0, DRAUGHT]
    body = cpt.FloatingBody(
        mesh.immersed_part(), dofs=cpt.rigid_body_dofs(rotation_center=centre), center_of_mass=cog, name="box"
    )
    body.hydrostatic_stiffness = body.compute_hydrostatic_stiffness(rho=1025.0, g=9.81)
    body.inertia_matrix = body.compute_rigid_body_inertia(rho=1025.0)
    common = {"body": body, "rho": 1025.0, "g": 9.81, "water_depth": np.inf}
    solver = cpt.BEMSolver()
    problems = [
        cpt.RadiationProblem(omega=w, radiating_dof=dof, **common) for w in [*OMEGA, np.inf] for dof in body.dofs
    ]
    problems += [
        cpt.DiffractionProblem(omega=w, wave_direction=d, **common)
        for w in OMEGA
        for d in np.deg2rad(np.arange(0, 181, 30))
    ]
    return cpt.assemble_dataset(solver.solve_all(problems, progress_bar=False), hydrostatics=True)


def particulars(x_origin, centre):
    return Particulars(
        name="box",
        cog=COG,
        origin=np.array([x_origin, 0.0, DRAUGHT]),
        centre=np.array(centre),
        draught=DRAUGHT,
        length=LENGTH,
        volume=VOLUME,
        centre_of_buoyancy=np.array([MIDSHIP, 0.0, KB]),
        gravity=9.81,
    )


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """NetCDF and WAMIT files about two origins and centres."""
    folder = tmp_path_factory.mktemp("capytaine")
    cpt = pytest.importorskip("capytaine")
    wamit = pytest.importorskip("capytaine.io.wamit")
    places = {"here": (12.0, (0.0, 0.0, 0.5)), "there": (8.0, (1.5, 0.0, -1.0))}
    for name, place in places.items():
        dataset = solved(*place)
        cpt.export_dataset(folder / f"{name}.nc", dataset)
        wamit.export_to_wamit(dataset, str(folder / name), exports=("1", "3", "hst"))
    return folder, places


def test_conventions_by_long_waves(exported):
    folder, places = exported
    data = import_capytaine(folder / "here.nc", particulars(*places["here"]), fit=without_fit)
    k = data.omega[0] ** 2 / data.gravity
    d = data.direction
    np.testing.assert_allclose(data.excitation[0, :, 2] / data.restoring[2, 2], 1.0, atol=0.1)
    for mode, toward in ((0, np.cos(d)), (1, np.sin(d))):
        scale = k * data.gravity * (data.mass + data.added_mass[0, mode, mode])
        np.testing.assert_allclose(data.excitation[0, :, mode] / scale, 1j * toward, atol=0.1)
    assert data.restoring[2, 2] == pytest.approx(1025.0 * 9.81 * np.pi / 4 * LENGTH * BEAM, rel=0.03)
    roll = np.pi / 64 * LENGTH * BEAM**3 + VOLUME * (KB - COG[2])
    assert data.restoring[3, 3] == pytest.approx(1025.0 * 9.81 * roll, rel=0.06)


def test_origin_and_rotation_centre_do_not_matter(exported):
    folder, places = exported
    one, two = (
        import_capytaine(folder / f"{name}.nc", particulars(*place), fit=without_fit) for name, place in places.items()
    )
    for name in ("added_mass", "added_mass_inf", "damping", "restoring", "excitation"):
        expected = getattr(one, name)
        np.testing.assert_allclose(getattr(two, name), expected, atol=2e-3 * np.abs(expected).max(), err_msg=name)


def test_wamit_files_say_the_same(exported):
    folder, places = exported
    about = particulars(*places["there"])
    ours = import_capytaine(folder / "there.nc", about, fit=without_fit)
    theirs = import_wamit(folder / "there", about, fit=without_fit)
    for name in ("added_mass", "added_mass_inf", "damping", "restoring", "excitation"):
        expected = getattr(ours, name)
        np.testing.assert_allclose(getattr(theirs, name), expected, atol=1e-5 * np.abs(expected).max(), err_msg=name)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            lambda file: file.drop_vars("hydrostatic_stiffness"),
            "no 'hydrostatic_stiffness'.*compute_hydrostatic_stiffness",
        ),
        (lambda file: file.drop_vars("added_mass"), "no 'added_mass', expected a data set"),
        (
            lambda file: file.sel(radiating_dof=["Heave"], influenced_dof=["Heave"]),
            "degrees of freedom .'Heave'., expected",
        ),
        (lambda file: file.isel(omega=[0, 1, 2]), "3 finite frequencies, expected at least 8"),
    ],
)
def test_what_a_file_lacks_is_named(exported, tmp_path, change, told):
    xarray = pytest.importorskip("xarray")
    folder, places = exported
    with xarray.open_dataset(folder / "here.nc") as file:
        change(file.load()).to_netcdf(tmp_path / "less.nc")
    with pytest.raises(ConfigError, match=told):
        import_capytaine(tmp_path / "less.nc", particulars(*places["here"]), fit=without_fit)


def test_a_file_of_another_kind_is_refused(tmp_path):
    pytest.importorskip("xarray")
    (tmp_path / "text.nc").write_text("no data")
    with pytest.raises(ConfigError, match=r"text.nc: cannot be read as NetCDF"):
        import_capytaine(tmp_path / "text.nc", particulars(0.0, (0.0, 0.0, 0.0)), fit=without_fit)
