"""What shows that the physics holds: experiments with the run's own kernels, and the page that tells their results."""
