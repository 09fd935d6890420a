"""What the page on dynamic positioning says of each check, in plain words."""

OPENING = """\
Whole scenarios run in one process: sea, hull, thrusters, sensors with their noise, crane and load, and the chain
sensors, observer, reference, controller, allocation with the settings of `config/dp.yaml`. The ship drifts from
t = 0 and DP is switched on at 50 s, at the set-point where she started. Position is that of the CoG."""

STATION = """\
The lift of cases 2 and 3 with the crane at location B: calm water, E1 (Hs 0.3 m, current 0.5 m/s, wind 1 m/s) and
E2 (Hs 0.5 m, 1 m/s, 3 m/s), from 45 degrees on the starboard bow. First-order motion counts in the figures.

In E2 the ship is 25 m off at switch-on and 34 m before she turns back, and the bow tunnel is saturated while she goes
abeam against the current. By 200 s she is near, not settled: her heading is 5 degrees off and within 2 degrees
some 70 s later."""

WAVES = """\
Power between 0.06 and 0.2 Hz (Welch's estimate, segments of 100 s) of the load that DP asks for, with the passive
observer over without any observer: there the controller gets the measured pose and the true velocity, first-order
motion included. Same sea, same noise. The load that the thrusters give (with the measured wind's) is told beside it;
without filter their rates cut it, so that its ratio is larger."""

OBSERVER = """\
E1 with position noise of 0.5 m at 10 Hz. The drift of the position reference (0.1 m) is switched off here: no observer
can tell it from motion. The slow truth is the true pose below 0.05 Hz, filtered without delay. The bias should be what
moves the observer's ship as the true one moves, less what it knows of: `M nu' + D nu - tau` below 0.02 Hz.

White noise alone would leave 0.09 m in the estimate with these gains; that, and the phase that the loop loses, is why
the wave filter is narrow (damping 0.4) and its cut-off below the waves' frequency (0.8 of it)."""

BOX = """\
`config/scenarios/dp_box.yaml`: no waves, 5 m/s of gusty wind, position noise 0.5 m. Every side takes the ship 10 m and
turns her by 45 degrees at the same time, 160 s each; the reference goes at 0.3 m/s. Overshoot is that of the slow
motion beyond the set-point, along the leg. The azimuths' rates are taken between all macro steps of 20 ms. They turn
at their limit often: demands are small in such weather, and their direction follows the noise."""

ALLOCATION = """\
The quadratic program without rates: half of the demands are loads of random thrust within all limits and forbidden
zones, so they can be given; the others are such loads times 0.5 to 3. Limits are judged with yaw first, as
configured. The direction of the force is judged with position first: with yaw first it gives way to yaw. That nothing
misses less is shown against linear programs in `test/control/test_allocation.py`."""

CAPABILITY = """\
Static balance of wind, the sea that goes with it (DNV-ST-0111) and current from one direction against all that the
thrusters can give; without allowance for gusts, control and forbidden zones."""

STABILITY = """\
The loop linearised at rest, heading north: ship with low-frequency added mass, thruster lag 0.7 s, half a period of
hold, PID, and the passive observer at the waves of E1 and E2 (10 s), or measured pose and velocity. The largest real
part over all wave periods that the adaptive filter can find is judged too. Margins are those of one axis with the
others closed, cut at the force on the ship behind where the observer learns of it."""

LIFT = """\
`config/scenarios/dp_slew_lift.yaml`: 5 t at 8 m radius, slewed by 180 degrees over the stern and back within 77 s
each way, calm water, perfect sensors, so that nothing but the crane moves the ship. With feed-forward DP counters the
horizontal part of the crane's measured wrench, low-passed (30 s), and the observer knows of it. A row holds if
feed-forward makes the excursion no larger."""

FAULTS = """\
E2, at 300 s: one azimuth fails, half of the power is left, the position reference is lost for 60 s (dead reckoning),
the port azimuth runs away to full thrust while DP opposes it (drive-off), or all power is lost (drift-off). A
failed azimuth stands still, so the other one may point its jet at it: forbidden zones count only while what they
protect works. What the operator is told:"""

CAPTIONS = {
    "station": "Distance is linear below 1 m and logarithmic above.",
    "waves": "What DP asks for; the swell stands at 0.1 Hz.",
    "observer": "Top: errors; bottom: the load that the observer does not know, estimated and true.",
    "box": "The track from the first move on; arrows show the bow at the set-points.",
    "capability": "Largest wind that is held by direction, intact and with one thruster lost.",
    "loop": "The wave filter takes the waves' frequency out of the loop and costs phase below it.",
    "lift": "Slewing takes the ship a few centimetres; feed-forward takes most of that away.",
    "faults": "Excursions after the fault.",
}
