"""One-sided wave spectra: energy per angular frequency [m2 s]; their integral is the variance of the elevation."""

import numpy as np

from shipcrane_twin.physics.arrays import Array


def grid(period: float) -> Array:
    """Return frequencies (n,) [rad/s] that resolve any of these spectra with a peak at the period [s].

    Notes
    -----
    0.2 to 20 times the peak frequency in ratios of 0.2 %, where a JONSWAP peak is 7 % wide; the energy
    above is below 1e-5 of a JONSWAP spectrum and below 1e-3 of `torsethaugen`.
    """
    if not period > 0.0:
        raise ValueError(f"wave spectrum: the peak period is {period:g} s, expected above 0")
    return 2.0 * np.pi / period * np.geomspace(0.2, 20.0, 2304)


def jonswap(omega: Array, height: float, period: float, gamma: float) -> Array:
    """Return the JONSWAP spectrum (n,) [m2 s].

    Parameters
    ----------
    omega : float64, shape (n,)
        Positive frequencies [rad/s].
    height, period : float
        Significant wave height ``4 sqrt(m0)`` [m], peak period [s].
    gamma : float
        Peak enhancement, 1 to 10; 3.3 on average in the JONSWAP experiment, 1 is `pierson_moskowitz`.

    Raises
    ------
    ValueError
        If a parameter is outside its range.

    Notes
    -----
    DNV-RP-C205 section 3.5 with sigma 0.07 and 0.09, but normalised by quadrature to ``m0 = Hs^2 / 16``
    instead of its approximation ``1 - 0.287 ln gamma``, which errs by up to 1 % of the energy.
    """
    check(omega, height, period)
    if not 1.0 <= gamma <= 10.0:
        raise ValueError(f"JONSWAP: gamma is {gamma:g}, expected 1 (Pierson-Moskowitz) to 10")
    ratio = np.geomspace(0.2, 50.0, 4096)
    area = np.trapezoid(shape(ratio, gamma, 5.0), ratio)
    peak = 2.0 * np.pi / period
    return height**2 / 16.0 / (area * peak) * shape(omega / peak, gamma, 5.0)


def pierson_moskowitz(omega: Array, height: float, period: float) -> Array:
    """Return the Pierson-Moskowitz spectrum (n,) [m2 s] of a fully developed sea; see `jonswap`.

    Notes
    -----
    The two-parameter form of DNV-RP-C205 section 3.5, also named after Bretschneider and ISSC:
    ``S = 5/16 Hs^2 wp^4 w^-5 exp(-5/4 (wp/w)^4)``.
    """
    check(omega, height, period)
    peak = 2.0 * np.pi / period
    return 5.0 / 16.0 * height**2 / peak * shape(omega / peak, 1.0, 5.0)


def torsethaugen(omega: Array, height: float, period: float, gravity: float) -> Array:
    """Return the two-peaked spectrum (n,) [m2 s] of wind sea and swell together.

    Parameters
    ----------
    omega : float64, shape (n,)
        Positive frequencies [rad/s].
    height, period : float
        Significant wave height [m] and period of the higher peak [s] of the whole sea.
    gravity : float
        [m/s2].

    Raises
    ------
    ValueError
        If a parameter is outside its range.

    Notes
    -----
    The simplified form (Torsethaugen and Haver 2004; DNV-RP-C205 appendix A), made for the
    Norwegian shelf with a fetch of 370 km. Each peak is normalised by quadrature to its share of the energy.
    """
    check(omega, height, period)
    # Period of a fully developed wind sea of this height; above it, swell is the higher peak.
    developed = 6.6 * height ** (1.0 / 3.0)
    if not (developed < 25.0 and period < 25.0):
        raise ValueError(
            f"Torsethaugen: height {height:g} m, period {period:g} s; expected a height below 54 m, a period below 25 s"
        )
    if period <= developed:
        steep = developed - 2.0 * np.sqrt(height)
        if not steep > 0.0:
            raise ValueError(f"Torsethaugen: the height {height:g} m is beyond the model's range")
        part = 0.7 + 0.3 * np.exp(-((2.0 * (developed - period) / steep) ** 2))
        gamma = 35.0 * (2.0 * np.pi / gravity * part * height / period**2) ** 0.857
        second_period = developed + 2.0
        second = np.sqrt(1.0 - part**2) * height
    else:
        beyond = (period - developed) / (25.0 - developed)
        part = 0.6 + 0.4 * np.exp(-((beyond / 0.3) ** 2))
        gamma = 35.0 * (2.0 * np.pi / gravity * height / developed**2) ** 0.857 * (1.0 + 6.0 * beyond)
        second = np.sqrt(1.0 - part**2) * height
        second_period = 6.6 * second ** (1.0 / 3.0)
    first = peak_of_four(omega, part * height, period, max(gamma, 1.0))
    if second < 1e-3 * height:  # the formula's period of a vanishing wind sea vanishes as well
        return first
    return first + peak_of_four(omega, second, second_period, 1.0)


def peak_of_four(omega: Array, height: float, period: float, gamma: float) -> Array:
    """Return one of Torsethaugen's peaks (n,) [m2 s], whose tail falls with the fourth power."""
    ratio = np.geomspace(0.2, 500.0, 4096)
    area = np.trapezoid(shape(ratio, gamma, 4.0), ratio)
    peak = 2.0 * np.pi / period
    return height**2 / 16.0 / (area * peak) * shape(omega / peak, gamma, 4.0)


def shape(ratio: Array, gamma: float, power: float) -> Array:
    """Return ``r^-n exp(-n/4 r^-4) gamma^exp(-(r-1)^2 / (2 sigma^2))`` (n,) of frequencies over the peak's."""
    sigma = np.where(ratio <= 1.0, 0.07, 0.09)
    enhanced = gamma ** np.exp(-0.5 * ((ratio - 1.0) / sigma) ** 2)
    return ratio**-power * np.exp(-0.25 * power * ratio**-4.0) * enhanced


def check(omega: Array, height: float, period: float) -> None:
    """Refuse frequencies, heights and periods that no sea has."""
    if not (np.isfinite(omega).all() and np.min(omega) > 0.0):
        raise ValueError("wave spectrum: frequencies must be positive and finite [rad/s]")
    if not 0.0 < height < np.inf:
        raise ValueError(f"wave spectrum: the significant height is {height:g} m, expected above 0")
    if not 0.0 < period < np.inf:
        raise ValueError(f"wave spectrum: the peak period is {period:g} s, expected above 0")
