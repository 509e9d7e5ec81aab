//! The programs before the real rclpy, one file a subject. One program of tests: each program of its
//! own would be linked to the whole of the nodes once more. One session after the other.

mod cdr_rclpy;
mod commission_rclpy;
mod described_rclpy;
mod endurance_rclpy;
mod frozen_rclpy;
mod hostile_rclpy;
mod large_answers_rclpy;
mod latched_rclpy;
mod latecomers_rclpy;
mod launch_rclpy;
mod live_nodes_rclpy;
mod live_rclpy;
mod nodes_rclpy;
mod restarts_rclpy;
mod runner_rclpy;
mod served_rclpy;
mod writers_rclpy;
