"""Bags of the friction laboratory as tables and figures, live plots, and experiments from Python.

`bag`, `stribeck`, `figures` and `table` need no ROS; `live` and `experiment` need rclpy and friction_msgs, and import them
only when they are used. `experiment` in turn needs neither pandas nor matplotlib.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from friction_analysis.bag import Bag, BagError, read_bag
    from friction_analysis.console import AnalysisError
    from friction_analysis.stribeck import BinnedCurve, binned

__all__ = ["AnalysisError", "Bag", "BagError", "BinnedCurve", "binned", "read_bag"]

# What can be had from here, and the module it is in; loaded when it is asked for.
_HOMES = {
    "AnalysisError": "console",
    "Bag": "bag",
    "BagError": "bag",
    "BinnedCurve": "stribeck",
    "binned": "stribeck",
    "read_bag": "bag",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"friction_analysis has no {name}; it has {', '.join(__all__)}")
    return getattr(import_module(f"friction_analysis.{_HOMES[name]}"), name)
