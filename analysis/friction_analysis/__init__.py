"""Bags of the friction laboratory as tables and figures, live plots, and experiments from Python.

`bag`, `stribeck`, `figures` and `table` need no ROS; `live` and `experiment` need rclpy and friction_msgs, and import them
only when they are used.
"""

from friction_analysis.bag import Bag, BagError, read_bag
from friction_analysis.console import AnalysisError
from friction_analysis.stribeck import BinnedCurve, binned

__all__ = ["AnalysisError", "Bag", "BagError", "BinnedCurve", "binned", "read_bag"]
