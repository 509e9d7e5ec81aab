"""What fleets need beyond the rest of the package; a sentence says how to get it."""

from __future__ import annotations

import importlib
from typing import Any

from ..errors import BadInput


def needed(module: str, extra: str) -> Any:
    """A module of an optional extra of the wheel."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        if error.name is not None and error.name.split(".")[0] == module.split(".")[0]:
            package = module.split(".")[0]
            text = f"this needs the package {package}, which is not installed; `pip install 'frictionlab[{extra}]'` installs it"
            raise BadInput(text) from None
        raise
