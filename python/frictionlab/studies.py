"""What is computed from models: their features, and gains of a linear controller."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from . import _native
from ._given import options

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Features:
    """What tells models apart, as `features.json` has it."""

    document: dict[str, Any] = field(repr=False)
    text: str
    _html: str = field(repr=False)

    def to_html(self) -> str:
        """The whole report."""
        return self._html

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(self.text)}</pre>"


def features(model: str | Iterable[str] = (), *, jobs: int | None = None) -> Features:
    """Stick-slip, memory, lag, breakaway and more of these models, of all if none is named."""
    names = [model] if isinstance(model, str) else list(model)
    document, html, text = _native.features(names, jobs)
    return Features(json.loads(document), text, html)


@dataclass(frozen=True)
class Design:
    """Gains, and what they are worth, as `design.json` has it."""

    document: dict[str, Any] = field(repr=False)
    text: str
    _html: str = field(repr=False)
    _yaml: str = field(repr=False)

    @property
    def gains(self) -> dict[str, float]:
        """The gains of the law."""
        return dict(self.document["gains"])

    @property
    def remarks(self) -> list[str]:
        """What is proven of the loop under friction, in sentences."""
        return list(self.document["remarks"])

    def to_pandas(self) -> pd.DataFrame:
        """Figures of the step response, a row a definition of rise and settling."""
        import pandas as pd

        return pd.DataFrame(self.document["step"])

    def to_yaml(self) -> str:
        """`controller.yaml`, which `run --parameters` reads."""
        return self._yaml

    def to_html(self) -> str:
        """The whole report."""
        return self._html

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(self.text)}</pre>"


def design(loop: str, **keywords: Any) -> Design:
    """Gains of a loop, `velocity` or `position`; keywords are the options of `frictionlab design`.

    >>> sorted(design("velocity", crossover=150, phase_margin=60).gains)
    ['k_i', 'k_p']
    """
    document, html, yaml, text = _native.design([loop, *options(keywords)])
    return Design(json.loads(document), text, html, yaml)
