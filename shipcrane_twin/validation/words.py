"""What the validation page says of each check, in plain words."""

HULL = """\
The mesh of the parametric hull against ShipX's hydrostatics of R/V Gunnerus, elongated (references with their
sources in [`validation/hull.py`](../shipcrane_twin/validation/hull.py)). ShipX has two displacements: 493.5 t
in its hydrostatic file, which the volume is held against, and 482.0 t in its motion model, which GM_T is
derived with. Ours is the first, so GM_T comes out lower although C44 agrees."""

PANELS = """\
Added mass, damping and wave loads of the mesh against one with twice as many panels: largest change at five
frequencies from 0.5 to 4 rad/s and five directions, as a share of the largest value over both."""

NO_PANELS = """\
Left out of this page; `./twin hydro validate --panels` computes it with Capytaine in a minute."""

STATE_SPACE = """\
The radiation memory `K(iw) = B + i w (A - A_inf)` of the run (eight poles for surge, heave and pitch, eight for
sway, roll and yaw, 48 states) against the panel method, up to 4 rad/s, for every entry above 5 % of its
diagonal scale. The model is passive: the real part has no negative eigenvalue, so memory never feeds a motion."""

MOTIONS = """\
The free ship, from rest, in a regular wave of 0.01 m amplitude that grows over 40 s; after another 160 s a
cosine, a sine and a slow parabola are fitted to six cycles. Hull, memory and wave loads are the run's own
kernels. Against them stand the linear equations with the panel method's tables and the same viscous damping.
The difference is that of complex numbers (amplitude and phase), as a share of the largest motion over
directions at that frequency. In higher waves the ship drifts away from where it started, which shifts phases,
and quadratic drag matters; linear theory knows neither."""

MOTIONS_CAPTION = "Amplitudes of both ways; roll is largest near 1.05 rad/s, its natural frequency."

DRIFT = """\
First the load alone: what the kernel gives in a regular wave, averaged over a period, against the transfer
function. Then the whole ship through the chain of a run (weather with its slow pose, hull, memory, idle
thrusters; macro steps of 20 ms), in regular waves of 0.01 m, held by soft springs of 160 s natural period in
surge, sway and yaw: the mean of what the springs hold against the transfer function, wherever that is above 10 %
of its largest value.

The drag that grows with squared speed is switched off: in waves it has a mean of its own, which is real but not in
the transfer function. That first-order loads and motions make next to no mean load of their own is not a matter of
course. It takes waves that act at the slow pose (50 s), water loads in axes that neither roll nor yaw with the waves,
and yaw damping on the rate of the heading; in axes fixed to the ship the differences are several times the drift.
What is left near the roll resonance comes from the springs' dampers and the finite period of the slow pose."""

DRIFT_CAPTION = "Mean loads per squared amplitude at some of the frequencies."

SEA = """\
JONSWAP, Hs 2 m, Tp 8 s, gamma 3.3, long-crested, at a fixed point. Hs and crests: 60 components, the standard
of the kurtosis error 0.025. Chi-square: 2000 components, one five-minute record per sea. A right test at 5 %
rejects one sea in twenty; the bar is 5 % and 2.5 standard deviations of that share. The sharper test takes the
records of an eighth of the seas together; it tells a peak 5 % later, Hs 8 % higher or gamma 1.5 from what was
asked for. Crests: share of levels (1.5, 2, 2.5, 3 standard deviations) and seas with a number of crests outside
the 95 % band of Rayleigh's law; one in twenty is right. Lower crests are fewer than Rayleigh's law says in any
sea of this bandwidth."""

SPECTRUM_CAPTION = "The mean of all records lies on the spectrum as the window of a five-minute record sees it."
CRESTS_CAPTION = "Dotted: the judged levels. Rayleigh's band is that of one sea; below 1.5 bandwidth shows."

NO_VERES = """\
Left out of this page: the comparisons with VERES need its files of the same ship; `./twin hydro validate
--veres FOLDER` makes them."""

VERES = """\
Loads: the largest difference of amplitudes over all directions, as a share of the largest amplitude over all
directions at that period. This judges the amplitude only; the column beside it has the same of complex numbers,
phase included, and has no bar: strip theory and three-dimensional theory differ in the phase of pitch and heave
by more. Added mass: the largest difference over periods from 5 to 12 s as a share of VERES's value at that
period. Natural periods: each mode by itself, with its own mass (491.5 t here, 482.0 t in VERES) and the same
moments of inertia. Pictures: ours solid, VERES dashed."""

DIFFERENCES = """\
Nothing here is judged and nothing was tuned to come closer. VERES is strip theory: it cuts the ship into
sections, solves each as if it were endless, and adds them up. This ship is short (3.5 breadths), its ends are a
large part of it, and there water gets out of the way forward and aft, which sections cannot know.

- Added mass in pitch and yaw weights the ends with the square of their distance, so it suffers most: A66 is
  about half to two thirds of VERES's, A55 as little as two thirds. A lower A55 makes the natural period of
  pitch shorter. A22 is lower for the same reason, by up to a fifth.
- Damping falls much faster towards long waves in three dimensions: a body that is small beside the wave
  hardly makes waves, an endless section still does. So B22, B44, B55 and B66 are a small share of VERES's at
  12 s, B33 less than half, and come closer at 5 s. Where it matters, at resonance, heave's and pitch's damping
  are compared in the pictures; roll's is mostly viscous and a setting.
- Surge loads have no place in strip theory (VERES adds them by another method) and yaw loads weight the ends:
  F1 and F6 differ by up to a third at 6 s and more where they are small.
- Mean drift is each code's own: ours is from the far field. In sway they are alike; in surge
  VERES has two to three times ours in head and following waves near 1.5 rad/s, and ours goes on where VERES's falls
  to zero in short waves, which a ship this blunt reflects.
- Motions of heave and pitch differ less than the coefficients, because in waves longer than the ship stiffness
  and the Froude-Krylov load dominate, which both have alike. VERES's own extra viscous damping is left out on
  both sides here.

Ratios to VERES over periods from 5 to 12 s stand in the last column."""

IMPORTED = """\
VERES's files through `./twin hydro import veres`: motions rebuilt from the imported mass, added mass, damping,
stiffness and loads against those that VERES wrote itself, largest difference of amplitudes as a share of the
largest motion. Heave and pitch are judged. Roll, and with it sway and yaw, hangs on viscous roll damping, which
VERES linearises at a wave height and we do not; the rebuilt motions have 5 % of critical instead."""

DATABASE_CAPTIONS = {
    "hull": "The wetted hull: port half, mirrored by the solver.",
    "memory": "Retardation functions: lines from the damping, dots from the state-space model.",
    "excitation": "Amplitudes of the first-order wave loads.",
    "drift": "Mean second-order loads; VERES's, if drawn, are its own method's.",
    "added_mass": "Added mass.",
    "damping": "Radiation damping.",
    "coupling": "Coupling terms of the added mass.",
    "motions": "Motions with the run's linear damping; natural periods by each mode itself.",
}
