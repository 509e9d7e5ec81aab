"""What a run over a fleet found: the rows, and what they say of joints, machines, temperature and age."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from .dataset import Dataset
from .needs import needed
from .progress import counted

if TYPE_CHECKING:
    import pandas as pd


def read(out: str | os.PathLike[str], storage: Mapping[str, Any] | None = None) -> Fleet:
    """Open the dataset that `run` has written into a folder or a store."""
    dataset = Dataset(out, dict(storage or {}))
    if not dataset.about():
        raise BadInput(f"{os.fspath(out)} holds no fleet.json; `friction-fleet RECORDINGS --out FOLDER` makes one")
    return Fleet(dataset)


class Fleet:
    """The results of a fleet. What is computed of them is computed when it is first asked for."""

    def __init__(self, dataset: Dataset) -> None:
        self._dataset = dataset
        # `fleet.json`: settings, number of recordings, and whether all of them are through.
        self.about = dataset.about()

    def to_pandas(self, columns: list[str] | None = None) -> pd.DataFrame:
        """A row a recording, joint, model and parameter; recordings of which there is nothing say why in `error`."""
        files = int(self.about["files"])
        tables = [self._dataset.table(number, files, columns) for number in range(files)]
        pa = needed("pyarrow", "fleet")
        frame: pd.DataFrame = pa.concat_tables(tables).to_pandas()
        return frame

    @cached_property
    def estimates(self) -> pd.DataFrame:
        """The rows that the rest is computed of: of each joint the model that was chosen most often."""
        columns = ["uri", "machine", "joint", "time", "age_h", "temperature_c", "model", "chosen", "parameter", "value"]
        columns += ["unit", "standard_error", "identified", "error"]
        rows = self.to_pandas(columns)
        rows = rows[rows["error"].isna() & rows["value"].notna()]
        rows[["machine", "joint"]] = rows[["machine", "joint"]].fillna("")
        chosen = rows[rows["chosen"] == True].drop_duplicates(["uri", "joint"])  # noqa: E712 - it may hold none
        often = chosen.groupby(["joint", "model"]).size().reset_index(name="times")
        # Of two that were chosen as often, the first by name.
        often = often.sort_values(["joint", "times", "model"], ascending=[True, False, True]).drop_duplicates("joint")
        rows = rows.merge(often[["joint", "model"]], on=["joint", "model"])
        # A parameter that most recordings tell is taken from all that give it an error, as vague as it may be: to
        # take only what is sure of itself would favour large values.
        rows["identified"] = rows["identified"] == True  # noqa: E712
        told = rows.groupby(["joint", "parameter"])["identified"].transform("sum")
        rows = rows[(told > 0.5 * rows.groupby("joint")["uri"].transform("nunique")) & (rows["standard_error"] > 0.0)]
        order = "time" if rows["time"].notna().any() else "age_h"
        return rows.sort_values(["machine", "joint", "parameter", order, "uri"]).reset_index(drop=True)

    @property
    def failed(self) -> pd.DataFrame:
        """Recordings, or joints of them, that could not be used, and why."""
        rows = self.to_pandas(["uri", "machine", "joint", "error"])
        return rows[rows["error"].notna()].reset_index(drop=True)

    def joints(self, false_alarms: float = 0.01) -> pd.DataFrame:
        """A row a parameter of each joint: its pooled value, and whether it changed (see `changes`).

        `false_alarms` is the share of unchanged joints that are called changed, whatever the number of their
        parameters. The temperature is taken out where it is known of all recordings of the joint.
        """
        from .joints import joints

        return joints(self.estimates, false_alarms)

    def influences(self) -> pd.DataFrame:
        """How friction depends on temperature and age: per cent a kelvin and a thousand hours, over all joints."""
        from .joints import influences

        return influences(self.estimates)

    def outliers(self, false_alarms: float = 0.01) -> pd.DataFrame:
        """Recordings that are unlike the others of their joint; in the share `false_alarms` of fleets one is so by chance."""
        from .joints import outliers

        return outliers(self.estimates, false_alarms)

    def machines(self, false_alarms: float = 0.01) -> pd.DataFrame:
        """Machines compared: the pooled value of each beside where the others say that it lies."""
        from .joints import machines

        return machines(self.estimates, false_alarms)

    def pooled(self) -> pd.DataFrame:
        """A row a parameter of each kind of joint, pooled over runs and machines (see `pooled`)."""
        from .joints import over_machines

        return over_machines(self.estimates)

    def to_html(self, false_alarms: float = 0.01) -> str:
        """The page: one file that holds all it shows."""
        from .page import page

        return page(self, false_alarms)

    def write_page(self, false_alarms: float = 0.01) -> None:
        """Writes `report.html` and `joints.parquet` beside the results."""
        self._dataset.write("report.html", self.to_html(false_alarms))
        sink = io.BytesIO()
        self.joints(false_alarms).to_parquet(sink, index=False)
        self._dataset.write("joints.parquet", sink.getvalue())

    def __repr__(self) -> str:
        return f"<Fleet: {counted(self.about['recordings'], 'recording')} in {self._dataset.out}>"
