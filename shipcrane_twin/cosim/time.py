"""Simulated time: integer nanoseconds from 0, on a grid of macro steps."""

NS_PER_S = 1_000_000_000


def seconds(time_ns: int) -> float:
    """Return integer nanoseconds as seconds, for physics and people, never for comparing times."""
    return time_ns / NS_PER_S


def stamp_parts(time_ns: int) -> tuple[int, int]:
    """Return (sec, nanosec) of a ROS stamp."""
    return divmod(time_ns, NS_PER_S)
