"""The friction laboratory in Python: friction models, simulated and identified.

>>> import frictionlab
>>> frictionlab.Model("lugre").title
'LuGre'
"""

from ._native import Contact, __version__
from .comparison import Comparison, compare
from .errors import BadInput, Failure, FrictionlabError
from .export import Exported
from .identification import Estimate, Fit, Identification, Joints, identify, identify_joints
from .models import Model, ModelInfo, Parameter, models
from .simulation import Simulation, simulate
from .studies import Design, Features, design, features

__all__ = [
    "BadInput",
    "Comparison",
    "Contact",
    "Design",
    "Estimate",
    "Exported",
    "Failure",
    "Features",
    "Fit",
    "FrictionlabError",
    "Identification",
    "Joints",
    "Model",
    "ModelInfo",
    "Parameter",
    "Simulation",
    "__version__",
    "compare",
    "design",
    "features",
    "identify",
    "identify_joints",
    "models",
    "simulate",
]
