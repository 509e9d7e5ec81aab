//! Tests that cross crates: the built program, real rosbags, real rclpy, a real browser.
