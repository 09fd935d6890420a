"""What the page on crane and load says of each check, in plain words."""

OPENING = """\
Two cranes: the Palfinger knuckle boom of R/V Gunnerus (four joints, a telescope of eight segments; 6 t) and a subsea
knuckle boom (three joints, 40 t). Experiments on a part use the run's own kernels; the others are whole scenarios in
one process, sea and ship included."""

KINEMATICS = """\
Joints and tip from cylinder lengths against poses that the crane of the published co-simulation computes itself."""

DYNAMICS = """\
Both cranes as they stand in `config/cranes/`, in random states: mass matrix, Coriolis forces, weight, joint efforts,
and force and moment on the ship, with all six velocities and accelerations of the base and a force on the tip. In
Pinocchio every telescope segment is a prismatic joint, tied to its telescope by the quintic that rounds the
hand-over. Relative to the largest entry."""

ENERGY = """\
The drives' oil without damping and 60 times softer, so that joints swing through degrees and decimetres and the
telescope's segments hand over again and again; the brakes shut, so that nothing adds or takes energy; 300 s, micro
steps of 1.25 ms. Energy of links, weight and oil, over the kinetic energy exchanged."""

WORK = """\
The lift of case 2 on the moving ship: lift, take inboard, lower, slew over the stern, off-load, 480 s. All work done
on the crane is added up at every macro step of 20 ms from what the run publishes: drives (effort times rate), ship
(mean wrench times mean twist at the base), wire (the force that the crane felt times the way of the tip). Kinetic and
potential energy change by just that. The wire's force comes a step late; what work that makes or takes at the tip is
told beside it."""

WIRE = """\
A point mass under a moving pivot against a rigid pendulum solved by Dormand and Prince's method of order 8 (tolerance
1e-11; the wire made a thousandfold stiff for it), the steady sway against `1 / (1 - r^2)`, and the snap against a
mass that falls onto an elastic wire, `m g + sqrt((m g)^2 + 2 k m g h)`."""

SPLASH = """\
A closed box of 4 m by 3 m by 2 m lowered through still water at 0.5 m/s, against the terms of DNV-RP-N103 (4.3) by
hand: buoyancy, drag, slamming while the added mass grows, added mass. Within 5 cm of where slamming begins and ends,
which it does softly here, the force is not judged."""

SERVO = """\
Every joint of both cranes, the safe working load on the tip, on a level ship and with 5 degrees of roll at 8 s: at
rest, then 32 s at 80 % of the rated speed with the longest lever arm, then at rest again. Overshoot is the largest
rate beyond the command while it lasts, roll included; the steady error is that of the mean over the last two roll
periods. The ripple that roll leaves is told beside it: the oil yields a few millimetres to the load's swing, and so
it does when the brake is shut."""

ABUSE = """\
10,000 steps of the whole twin in E2 while an operator says anything to crane and winch: spells of silence, one
command held (up to ten times what a joint can do), a reversal at every step, floods of 40 messages between two steps,
numbers that are none, infinities, names that are wrong, lists that do not fit. The wire is taken in to its shortest,
0.2 m, on which the load swings round as it likes. Ends, force and the winch's limits are judged on what is published;
speed, acceleration and ends of the reference, which is what the drives are told, on the crane by itself with random
rates and positions. An actuator may go faster than its rated speed where the load pulls at the oil."""

COMPENSATION = """\
Heave compensation (`config/scenarios/heave_compensation.yaml`): a load on 10 to 80 m of wire in E2; spectra by
Welch's method from 100 s on, segments of 80 s. Between 0.05 and 0.2 Hz as a whole, and at the worst single frequency
(the part of the load's heave that follows the tip's, where the tip's density is at least 2 % of its peak). A load that
swings rises twice in every swing, above the band on short wire: that is no heave of the tip and stays."""

SWAY = """\
Anti-sway (`config/scenarios/anti_sway.yaml`): a quarter turn with the load on 8 m of wire in calm water; sway from 7
s after the end of the command."""

STRUCTURE = """\
5.6 t taken outward with the telescope until the limiter stops it; the telescope's centre of gravity over its
extension; the boom run into its end; and the boom lifting half of the safe load when the power fails at 10 s: the
brakes shut, the drives coast against their friction alone, or the load-holding valves leak."""

CAPTIONS = {
    "energy": "Energy of both cranes swinging without damping: kinetic energy, and what the total is off its start.",
    "work": "Work done on the crane in the lift of case 2, and the change of its energy on top of it.",
    "wire": "The load under a moving pivot, sway over pivot motion, and a snap, in closed form dashed.",
    "splash": "Forces on the box on its way down, kernel (lines) and hand calculation (dots), and its added mass.",
    "servo": "Rates over the commanded ones, full load: level ship and roll of 5 degrees.",
    "abuse": "Actuators between their ends and the paid-out length under random commands.",
    "heave": "Heave of tip and load: spectra, and the load's over the tip's.",
    "sway": "Sway of the load with and without anti-sway.",
    "structure": "Load chart with the way of a load to the cut-out, utilisation, telescope, end stop, power failures.",
}
