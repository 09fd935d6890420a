"""Scenarios that read well but cannot be built."""

import pytest

from shipcrane_twin.config.load import list_scenarios, load_scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim.check import check_buildable
from shipcrane_twin.cosim.coupling import SCHEMES

REFUSED = {
    "near miss of a scheme": ("coupling=in_trun", "coupling is 'in_trun'; did you mean in_turn?"),
    "no such scheme": ("coupling=zzz", "coupling is 'zzz'; known here: in_turn, in_turn+inertia"),
    "posture beyond a cylinder": (
        "crane.initial_joints.1=1.6",
        "crane.initial_joints has 1.6 for boom, expected -0.6558 to 0.8954, where its cylinder ends",
    ),
    "cylinder shorter than short": (
        "crane.links.1.drive.length_min_m=5.0",
        "expected length_min < length_max",
    ),
    "cylinder that cannot close": ("crane.links.1.drive.length_max_m=2.5", "cannot close its triangle; expected"),
    "margin that leaves no stroke": (
        "crane.links.1.drive.end_margin_m=0.5",
        "expected >= 0 and less than half of every stroke",
    ),
    "impossible inertia": (
        "crane.links.1.inertia_kg_m2=[1.0, 100.0, 0.0, 1.0, 0.0, 1.0]",
        "expected none negative and none greater than the sum of the others",
    ),
    "capsizing crane": ("crane.links.1.mass_kg=5.0e+5", "the ship finds no equilibrium below 40 degrees of heel"),
    "filter that adds waves": ("dp.observer.passive.notch_damping=[0.05, 0.7, 0.7]", "the filter would add waves"),
    "every fix late": ("dp.observer.lost_after_s=0.05", "every fix is late"),
    "waves longer than any": ("dp.observer.wave_period_s=40.0", "wave frequency: lowest "),
    "thrusters of another ship": (
        "vessel.thrusters.2.name=bow",
        "expected azimuth_port, azimuth_starboard, bow_tunnel in this order",
    ),
    "drive too weak": ("crane.links.1.drive.pressure_max_pa=1.0e+6", "the boom needs "),
    "servo steps too long": ("crane.servo.micro_step_max_ms=50.0", "too long for the fastest servo mode"),
}


@pytest.mark.parametrize(("override", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_message_says_what_cannot_be_built_and_why(override, said):
    scenario = load_scenario("case2", [override, "macro_step_ms=50.0"])
    with pytest.raises(ConfigError) as caught:
        check_buildable(scenario)
    message = str(caught.value)
    assert message.startswith("case2: ")
    assert said in message
    assert "\n" not in message


@pytest.mark.parametrize("name", list_scenarios())
@pytest.mark.parametrize("coupling", SCHEMES)
def test_good_scenarios_pass(name, coupling):
    check_buildable(load_scenario(name, [f"coupling={coupling}"]))
