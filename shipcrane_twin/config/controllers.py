"""Settings of the controllers that join the lockstep, and what is wrong across them."""

from collections.abc import Collection
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Len, Lt
from pydantic import Discriminator

from shipcrane_twin.config.crane import NotNegative, Positive
from shipcrane_twin.config.settings import Number, Text, settings

ANTI_SWAY_JOINTS = ("slew", "boom")


@settings
class HeaveCompensationConfig:
    """Active heave compensation on the winch; ``winch_lag_s`` is the time constant of a winch that lags its command."""

    kind: Literal["heave_compensation"]
    enabled_at_s: NotNegative
    corner_period_s: Annotated[Number, Ge(20), Le(2000)]
    winch_lag_s: Annotated[Number, Ge(0), Le(2)]
    speed_max_m_s: Positive
    accel_max_m_s2: Positive

    @property
    def name(self) -> str:
        """Of the node."""
        return self.kind


@settings
class AntiSwayConfig:
    """Anti-sway on slew and boom; ``damping_ratio`` 0 shapes the operator's commands and feeds nothing back."""

    kind: Literal["anti_sway"]
    damping_ratio: Annotated[Number, Ge(0), Le(0.7)]
    mean_time_s: Annotated[Number, Ge(5), Lt(1000)]
    tip_speed_max_m_s: Positive
    slew_rate_max_rad_s: Annotated[Number, Gt(0), Le(1)]
    boom_rate_max_rad_s: Annotated[Number, Gt(0), Le(1)]

    @property
    def name(self) -> str:
        """Of the node."""
        return self.kind


@settings
class ExternalConfig:
    """A controller of the user's own: a node that is awaited by stamp but not started by the run.

    ``mode``: its velocities replace the operator's or are added to them. ``inputs``: per-step topics that the
    node listens to; nothing is sent before it does.
    """

    kind: Literal["external"]
    name: Text
    topic: Text
    joints: Annotated[tuple[Text, ...], Len(1)]
    mode: Literal["add", "replace"]
    inputs: Annotated[tuple[Text, ...], Len(1)] = ("/payload/odom",)


ControllerConfig = Annotated[HeaveCompensationConfig | AntiSwayConfig | ExternalConfig, Discriminator("kind")]


def joints_of(controller: ControllerConfig) -> tuple[str, ...]:
    """Return the joints that a controller commands."""
    if isinstance(controller, ExternalConfig):
        return controller.joints
    return ANTI_SWAY_JOINTS if isinstance(controller, AntiSwayConfig) else ("winch",)


def steered_joints(controllers: Collection[ControllerConfig]) -> frozenset[str]:
    """Return the joints that controllers command: they take no positions."""
    return frozenset(joint for one in controllers for joint in joints_of(one))


def replaces(controller: ControllerConfig) -> bool:
    """Whether a controller's velocities stand in place of the operator's; else they are added."""
    return controller.mode == "replace" if isinstance(controller, ExternalConfig) else controller.kind == "anti_sway"


def controller_problems(
    controllers: tuple[ControllerConfig, ...], known_joints: Collection[str]
) -> list[tuple[list[str | int], str]]:
    """Return what is wrong across the controllers: key path and advice for each.

    Parameters
    ----------
    controllers : tuple of ControllerConfig
    known_joints : collection of str
        The crane's and the winch's.
    """
    found: list[tuple[list[str | int], str]] = []
    names: set[str] = set()
    moved: set[str] = set()
    for i, controller in enumerate(controllers):
        here: list[str | int] = ["controllers", i]
        if controller.name in names:
            found.append((here, f"expected one controller with the name {controller.name}"))
        names.add(controller.name)
        joints = joints_of(controller)
        unknown = [joint for joint in joints if joint not in known_joints]
        if unknown:
            known = ", ".join(known_joints)
            found.append((here, f"it commands the joint {unknown[0]}, expected joints of this crane: {known}"))
        if len(set(joints)) < len(joints):
            found.append(([*here, "joints"], "expected every joint once"))
        if replaces(controller):
            for joint in joints:
                if joint in moved:
                    advice = "one controller that replaces a joint's command, listed before those that add to it"
                    found.append((here, f"expected {advice}; see {joint}"))
        moved.update(joints)
    return found
