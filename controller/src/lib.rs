//! Velocity and position controllers designed from specifications, with friction compensation, and their ROS 2 node.
