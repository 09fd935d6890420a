"""Co-simulation: integer time, subsystems, coupling schemes and the in-process runner."""
