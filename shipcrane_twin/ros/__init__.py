"""The ROS side: topic table, message layouts, quality of service and the lockstep loop."""
