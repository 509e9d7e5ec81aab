"""Names of topics, services and actions."""

from __future__ import annotations


def topic_name(name: str, namespace: str = "") -> str:
    """Absolute name: `topic_name("joint_states", "axis_1")` is `/axis_1/joint_states`."""
    return "/" + "/".join(part for part in (*namespace.split("/"), *name.split("/")) if part)
