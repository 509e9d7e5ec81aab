//! ROS 2 interface package friction_msgs and its Rust types.
