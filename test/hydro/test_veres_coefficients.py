import numpy as np

from shipcrane_twin.hydro.veres_coefficients import evaluate


def test_poles_without_their_conjugate_count_by_their_real_part():
    """K(t) = Re sum c e^{l t}: its transform by quadrature, one pole alone and one pair."""
    factors = np.array([3.0 + 0.5j, 1.0 - 2.0j, 1.0 + 2.0j])
    poles = np.array([-0.8 + 2.0j, -0.5 + 1.0j, -0.5 - 1.0j])
    omega = np.array([0.1, 0.7, 1.5, 3.0])
    time = np.linspace(0.0, 60.0, 120001)
    memory = (factors[:, None] * np.exp(poles[:, None] * time)).sum(axis=0).real
    expected = [np.trapezoid(memory * np.exp(-1j * w * time), time) for w in omega]
    np.testing.assert_allclose(evaluate(factors, poles, omega), expected, atol=1e-5)
