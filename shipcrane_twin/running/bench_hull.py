"""What a Runge-Kutta step of the hull in waves costs, by wave components and states of the water's memory."""

import statistics
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import hydro_database, vessel_params
from shipcrane_twin.hydro.database import HydroDatabase
from shipcrane_twin.physics.radiation import RadiationParams, radiation_count
from shipcrane_twin.physics.sea.components import make_waves
from shipcrane_twin.physics.sea.loads import wave_load_params
from shipcrane_twin.physics.vessel import VesselParams
from shipcrane_twin.validation.regular_waves import ride

COMPONENTS = (20, 60, 200, 2000)
SECTION_SHARES = (0.5, 1.0, 2.0)
"""Sections of the memory in the bench over those of the ship's database."""

STEPS, REPEATS, STEP_S = 4000, 5, 0.02


def bench_hull(name: str, console: Console) -> None:
    """Print the cost of one step of hull, memory, first-order and drift loads, in microseconds."""
    scenario = load_scenario(name)
    params, data = vessel_params(scenario), hydro_database(scenario)
    table = Table(title=f"hull in waves, one Runge-Kutta step; median of {REPEATS} runs", title_justify="left")
    table.add_column("states of the memory", justify="right")
    for count in COMPONENTS:
        table.add_column(f"{count} components", justify="right")
    for share in SECTION_SHARES:
        sized = params._replace(radiation=resized(params.radiation, share))
        costs = [step_cost_us(sized, data, count) for count in COMPONENTS]
        table.add_row(str(radiation_count(sized.radiation)), *(f"{cost:.2f} us" for cost in costs))
    console.print(table)


def resized(memory: RadiationParams, share: float) -> RadiationParams:
    """Return a memory with more or fewer sections: some left out, or all twice with half the load each."""
    if share <= 1.0:
        count = round(memory.b.shape[1] * share)
        cut = (memory.a[:, :count], memory.b[:, :count], memory.c[:, :, :, :count])
    else:
        times = round(share)
        cut = (
            np.concatenate([memory.a] * times, axis=1),
            np.concatenate([memory.b] * times, axis=1),
            np.concatenate([memory.c / times] * times, axis=3),
        )
    return RadiationParams(*map(np.ascontiguousarray, cut))


def step_cost_us(params: VesselParams, data: HydroDatabase, count: int) -> float:
    """Return the median cost of one step with a number of wave components [us]."""
    rng = np.random.default_rng(0)
    waves = make_waves(
        np.full(count, 0.3 / np.sqrt(count)),
        np.sort(rng.uniform(0.4, 2.5, count)),
        rng.uniform(-0.5, 0.5, count),
        rng.uniform(0.0, 2.0 * np.pi, count),
        gravity=data.gravity,
        depth=data.depth,
        ramp=10.0,
    )
    loads = wave_load_params(waves, data.omega, data.direction, data.excitation, data.drift)
    ride(params, loads, waves, STEP_S, 2)
    spent = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        ride(params, loads, waves, STEP_S, STEPS)
        spent.append((time.perf_counter() - began) / STEPS * 1e6)
    return statistics.median(spent)
