"""Looks into the friction laboratory's bags without a ROS installation."""
