"""The page of a fleet: one HTML file with its pictures inside, which names everything it was computed by."""

from __future__ import annotations

import io
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from .progress import counted

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from .fleet import Fleet

# Rows of a table on the page; the dataset has all.
SHOWN = 60
# Points of a picture.
POINTS = 6000
INK, ALARM = "#33608c", "#b3391f"

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 62rem; padding: 0 1rem }
body { color: #1b1f24; background: #fff } table { border-collapse: collapse; font-size: 14px }
td, th { padding: 0.2rem 0.6rem; border-bottom: 1px solid #d8dde3; text-align: left }
td.n { text-align: right; font-variant-numeric: tabular-nums } .scroll { overflow-x: auto } svg { max-width: 100%; height: auto }
.alarm { color: #b3391f; font-weight: 600 } .note { color: #57606a }
@media (prefers-color-scheme: dark) { body { color: #e6e8eb; background: #16191d } td, th { border-color: #3a4048 }
 .note { color: #9aa4af } .alarm { color: #ff8a70 } svg { background: #fff } }
"""


def page(fleet: Fleet, false_alarms: float) -> str:
    """The page as text; the same fleet gives the same page."""
    estimates, joints = fleet.estimates, fleet.joints(false_alarms)
    failed, outliers = fleet.failed, fleet.outliers(false_alarms)
    machines, influences, pooled = fleet.machines(false_alarms), fleet.influences(), fleet.pooled()
    changed = joints[joints["changed"]] if len(joints) else joints
    unlike = machines[machines["unlike"]] if len(machines) else machines
    judged = len(joints[joints["judged"]].groupby(["machine", "joint"])) if len(joints) else 0
    of_joints = len(joints.groupby(["machine", "joint"])) if len(joints) else 0
    names = changed[["machine", "joint"]].drop_duplicates()
    through = f"{counted(fleet.about['recordings'], 'recording')}, {counted(of_joints, 'joint')}"
    parts = [
        "<h1>Friction of a fleet</h1>",
        f"<p>{through}. {_first(len(names), judged, false_alarms)}</p>",
        "" if fleet.about.get("complete") else '<p class="alarm">The run was stopped: not all recordings are in it.</p>',
        "<h2>Joints that changed</h2>",
        _changed(changed, judged, of_joints, false_alarms),
        *(_course(estimates, row, false_alarms) for _, row in changed.sort_values("probability_of_chance").head(6).iterrows()),
        "<h2>Temperature and age</h2>",
        _influences(influences, estimates),
        "<h2>Machines compared</h2>",
        f"<p>{len(unlike)} of {len(machines)} pooled values of a machine lie where the other machines would have one in "
        f"{100 * false_alarms:g} % of the cases for a parameter.</p>"
        if len(machines)
        else "<p>Five machines with the same joint are needed.</p>",
        _table(unlike, ["machine", "joint", "parameter", "value", "low_95", "high_95", "expected", "unit", "runs"]),
        "<h3>All machines together</h3>",
        "<p>Within: between runs of one machine. Between: between machines. Another machine lies between the last two in "
        "95 % of the cases.</p>",
        _table(
            pooled,
            [
                "joint",
                "parameter",
                "value",
                "low_95",
                "high_95",
                "within",
                "between",
                "another_low_95",
                "another_high_95",
                "unit",
                "runs",
                "machines",
            ],
        ),
        "<h2>Recordings unlike the others of their joint</h2>",
        f"<p>{len(outliers)} found. In {100 * false_alarms:g} % of fleets without any, one is named by chance.</p>",
        _table(outliers, ["uri", "machine", "joint", "parameter", "value", "expected", "unit"]),
        "<h2>Recordings that could not be used</h2>",
        f"<p>{failed['uri'].nunique()} of {fleet.about['recordings']}.</p>",
        _table(failed, ["uri", "joint", "error"]),
        "<h2>How it was computed</h2>",
        _method(fleet, false_alarms),
    ]
    title = "Friction of a fleet"
    head = (
        f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title><style>{STYLE}</style>'
    )
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{"".join(parts)}</body></html>\n'


def _first(changed: int, judged: int, false_alarms: float) -> str:
    if not judged:
        return "No joint could be judged for change: that needs the time or the age of every recording, and several recordings."
    expected = false_alarms * judged
    return f"Of {counted(judged, 'joint')} that could be judged, {changed} changed; chance alone would name {expected:.2g}."


def _changed(changed: pd.DataFrame, judged: int, of: int, false_alarms: float) -> str:
    columns = ["machine", "joint", "parameter", "difference", "difference_low_95", "difference_high_95", "value", "unit"]
    columns += ["begins", "known_from", "probability_of_chance"]
    note = f'<p class="note">{counted(of - judged, "joint")} with too few recordings to be judged.</p>' if judged < of else ""
    said = f"<p>An unchanged joint is named here in {100 * false_alarms:g} % of the cases.</p>" if judged else ""
    return said + _table(changed.sort_values("probability_of_chance"), columns) + note


def _course(estimates: pd.DataFrame, row: Any, false_alarms: float) -> str:
    """The estimates of a joint in their order, with their errors."""
    same = (
        (estimates["machine"] == row["machine"])
        & (estimates["joint"] == row["joint"])
        & (estimates["parameter"] == row["parameter"])
    )
    rows = estimates[same]
    figure, axes = _figure(2.4)
    at = np.arange(1, len(rows) + 1)
    errors = 1.96 * rows["standard_error"].fillna(0.0)
    axes.errorbar(at, rows["value"], yerr=errors, fmt="o", markersize=3, linewidth=0.8, color=INK)
    begin = int(np.argmax((rows["uri"] == row["begins"]).to_numpy()))
    axes.axvline(begin + 0.5, color=ALARM, linewidth=1.0)
    axes.set(xlabel="recording of the joint, in the order of time", ylabel=f"{row['parameter']} [{row['unit']}]")
    name = " ".join(part for part in (row["machine"], row["joint"]) if part)
    return f"<h3>{escape(name)}: {escape(row['parameter'])}</h3>" + _svg(figure)


def _influences(influences: pd.DataFrame, estimates: pd.DataFrame) -> str:
    if not len(influences):
        return "<p>Neither is known of two joints with three recordings each.</p>"
    text = "<p>Per cent of the parameter, within joints, with 95 % intervals over joints.</p>"
    text += _table(influences, ["joint", "parameter", "of", "slope", "low_95", "high_95", "unit", "joints", "runs"])
    drawn = influences.drop_duplicates(["joint", "parameter", "of"]).head(8)
    for _, row in drawn.iterrows():
        column = "temperature_c" if row["of"] == "temperature" else "age_h"
        rows = estimates[(estimates["joint"] == row["joint"]) & (estimates["parameter"] == row["parameter"])]
        level = rows.groupby("machine")["value"].transform("mean")
        # Every so many, so that a page stays small.
        step = max(1, len(rows) // POINTS)
        figure, axes = _figure(2.4)
        axes.plot(
            rows[column][::step],
            (100.0 * rows["value"] / level)[::step],
            ".",
            markersize=2,
            color=INK,
            alpha=0.5,
            rasterized=True,
        )
        label = "temperature [°C]" if column == "temperature_c" else "age [h]"
        axes.set(xlabel=label, ylabel=f"{row['parameter']} [% of its joint's mean]")
        text += f"<h3>{escape(' '.join(filter(None, (row['joint'], row['parameter']))))} over {row['of']}</h3>" + _svg(figure)
    return text


def _method(fleet: Fleet, false_alarms: float) -> str:
    told = {
        "program": f"frictionlab {fleet.about['program_version']}",
        "options": ", ".join(f"{name}={value}" for name, value in sorted(fleet.about["keywords"].items())) or "none",
        "estimates": "of each joint the model that was chosen most often, and its parameters that most recordings tell",
        "change": "self-starting CUSUM of recursive residuals (Brown, Durbin and Evans 1975; Hawkins 1987), the temperature "
        "taken out where it is known of every recording; the limit is found by simulation for "
        f"{100 * false_alarms:g} % false alarms a joint over its whole series",
        "pooled": "three levels, variances of Paule and Mandel (1982); intervals of Hartung and Knapp (2001), never narrower "
        "than with known errors",
        "temperature and age": "least squares within joints, relative to each joint's mean; covariance clustered by joint, "
        "Student's quantile",
        "unlike": "Student's deleted residuals, limit by Bonferroni",
    }
    rows = "".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in told.items())
    return f'<div class="scroll"><table>{rows}</table></div>'


def _table(rows: pd.DataFrame, columns: list[str]) -> str:
    if not len(rows):
        return ""
    used = [name for name in columns if rows[name].notna().any() and (rows[name] != "").any()]
    heads = "".join(f"<th>{escape(name.replace('_', ' '))}</th>" for name in used)
    lines = "".join(f"<tr>{''.join(map(_cell, line))}</tr>" for line in rows[used].head(SHOWN).itertuples(index=False))
    more = f'<p class="note">{len(rows) - SHOWN} more are in the dataset.</p>' if len(rows) > SHOWN else ""
    return f'<div class="scroll"><table><tr>{heads}</tr>{lines}</table></div>{more}'


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return f"<td>{escape(value)}</td>"
    if value is None or value != value:
        return "<td></td>"
    if isinstance(value, int | np.integer):
        return f'<td class="n">{value}</td>'
    return f'<td class="n">{value:.4g}</td>' if np.isfinite(value) else '<td class="n">open</td>'


def _figure(height: float) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, height), layout="constrained")
    axes = figure.subplots()
    axes.grid(alpha=0.3)
    return figure, axes


def _svg(figure: Figure) -> str:
    import matplotlib as mpl

    text = io.StringIO()
    # Neither a date nor a random name: the same fleet gives the same page.
    with mpl.rc_context({"svg.hashsalt": "frictionlab", "svg.fonttype": "none"}):
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]
