//! Friction observers over any model, and their ROS 2 node.
