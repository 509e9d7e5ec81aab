//! What every ROS 2 node of the laboratory needs and ros2-client does not give.
