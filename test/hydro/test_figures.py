import dataclasses

import matplotlib.image
import numpy as np
from imported_ships import a_ship, mass_of

from shipcrane_twin.hydro.database import RadiationFit
from shipcrane_twin.hydro.figures import draw, impulse


def box_mesh():
    points = np.array([[x, y, z] for x in (-20.0, 20.0) for y in (0.0, 5.0) for z in (-3.0, 0.0)])
    return points, np.array([[0, 2, 6, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]])


def test_every_figure_is_drawn_with_ink_in_it(tmp_path):
    data = a_ship()
    other = dataclasses.replace(data, name="other", excitation=1.2 * data.excitation)
    paths = draw(data, tmp_path / "new", other=other, mass6=mass_of(data), mesh=box_mesh())
    names = [path.stem for path in paths]
    assert names == ["hull", "added_mass", "damping", "coupling", "memory", "excitation", "drift", "motions"]
    for path in paths:
        picture = matplotlib.image.imread(path)[..., :3]
        assert picture.shape[1] == 1430, path
        assert 0.01 < (picture.min(axis=2) < 0.9).mean() < 0.4, path


def test_impulse_response_is_the_memory_of_the_model():
    # one section of K(s) = s / (s^2 + 2 d s + w0^2) in heave
    d, w0 = 0.3, 1.2
    a = np.tile([[0.0, 1.0], [-(w0**2), -2 * d]], (2, 1, 1, 1))
    b = np.tile([0.0, 1.0], (2, 1, 1))
    c = np.zeros((2, 3, 3, 1, 2))
    c[0, 1, 1, 0] = [0.0, 1.0]
    time = np.linspace(0.0, 10.0, 101)
    found = impulse(RadiationFit(a=a, b=b, c=c), time)
    p = np.sqrt(w0**2 - d**2)
    np.testing.assert_allclose(
        found[:, 2, 2], np.exp(-d * time) * (np.cos(p * time) - d / p * np.sin(p * time)), atol=1e-9
    )
    assert not np.delete(found.reshape(len(time), 36), 14, axis=1).any()
