"""The sea and the weather: wave spectra and their realisation, kinematics, loads on a ship, gusts, current.

World axes are ENU: x east, y north, z up, z = 0 the still water. A wave component is
``zeta = a cos(w t - k (x cos d + y sin d) + e)``; its direction d is where it goes, anticlockwise from east.
All randomness comes from a `numpy.random.Generator` that the caller seeds.
"""
