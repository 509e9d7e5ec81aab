//! The distributions of ROS 2 whose rclpy can be had from wheels.

use clap::ValueEnum;

/// A distribution of ROS 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Distribution {
    /// The one that the laboratory is made for.
    Kilted,
    /// The one before, which is supported for longer.
    Jazzy,
}

impl Distribution {
    /// Folder of its environment in the target folder.
    pub fn folder(self) -> &'static str {
        match self {
            Self::Kilted => "python",
            Self::Jazzy => "python-jazzy",
        }
    }

    /// rclpy with its middleware, and what the build of a message package needs.
    pub fn requirements(self) -> Vec<String> {
        let (packages, name) = match self {
            Self::Kilted => (KILTED, "kilted"),
            Self::Jazzy => (JAZZY, "jazzy"),
        };
        let of_ros = packages.iter().map(|package| format!("ros-{name}-{package}"));
        of_ros.chain(TOOLS.iter().map(ToString::to_string)).collect()
    }
}

const KILTED: &[&str] = &[
    "rclpy==9.1.2",
    "rmw-fastrtps-cpp==9.3.3",
    "common-interfaces==5.5.1",
    "rosidl-default-generators==1.7.1",
    "rosidl-core-generators==0.3.1",
    "rosidl-pycommon==4.9.5",
    "ament-cmake==2.7.3",
    "ament-cmake-include-directories==2.7.3",
    "ament-cmake-ros-core==0.14.5",
    "ament-package==0.17.2",
];

const JAZZY: &[&str] = &[
    "rclpy==7.1.6",
    "rmw-fastrtps-cpp==8.4.3",
    "common-interfaces==5.3.6",
    "rosidl-default-generators==1.6.0",
    "rosidl-core-generators==0.2.0",
    "rosidl-pycommon==4.6.6",
    "ament-cmake==2.5.4",
    "ament-cmake-include-directories==2.5.4",
    "ament-cmake-ros==0.12.0",
    "ament-cmake-gmock==2.5.4",
    "ament-cmake-gtest==2.5.4",
    "ament-cmake-pytest==2.5.4",
    "python-cmake-module==0.11.1",
    "ament-package==0.16.4",
];

/// What builds a message package.
const TOOLS: &[&str] = &["catkin_pkg==1.1.1", "cmake==4.4.4", "ninja==1.13.2"];
