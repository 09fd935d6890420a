"""Models of sea, ship, crane, wire and load as kernels over plain arrays: no ROS, no files."""
