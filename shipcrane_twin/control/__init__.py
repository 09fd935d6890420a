"""Controllers of ship and crane as pure functions, usable without ROS."""
