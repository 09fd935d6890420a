"""Recordings: write and read rosbag2 directories."""
