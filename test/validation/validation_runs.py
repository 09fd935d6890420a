"""Small extents of the validation, and where VERES's files are."""

from shipcrane_twin.validation.checks import Extent

SMALL = Extent(
    motion_omega=(1.05,),
    drift_omega=(1.65,),
    drift_step_deg=90,
    height_seeds=3,
    spectrum_seeds=16,
    crest_seeds=3,
)
