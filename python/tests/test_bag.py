import re

import numpy as np
import pytest
from conftest import DEFINITIONS, START

from friction_analysis import BagError, read_bag
from friction_analysis.rows import COLUMNS
from friction_analysis.table import main, read_table
from friction_analysis.topics import topic_name

# Numbers whose unit is none, or follows the mode.
UNITLESS = {"progress", "reference", "feedback", "error"}


def test_every_number_of_every_recorded_message_has_a_column_with_its_unit():
    for kind in (kind for kind in COLUMNS if kind.startswith("friction_msgs")):
        text = (DEFINITIONS / f"{kind.rsplit('/', 1)[1]}.msg").read_text(encoding="utf-8")
        numbers = set(re.findall(r"^float64 (\w+)$", text, re.MULTILINE))
        assert numbers, kind
        assert numbers - UNITLESS == set(COLUMNS[kind]), kind


def test_a_bag_is_a_table_a_topic_with_values_stamps_and_units(known):
    bag = read_bag(known.plain)
    assert bag.start_ns == START
    joints = bag.table("joint_states")
    assert list(joints.columns) == ["position_rad", "velocity_rad_s", "torque_Nm", "stamp_ns"]
    assert len(joints) == 2000
    assert joints.index.name == "t_s"
    assert joints.index[1] == pytest.approx(0.002, abs=1e-12)
    assert joints["stamp_ns"].iloc[1] == START + 2_000_000
    assert joints["stamp_ns"].dtype == np.int64, "nanoseconds since 1970 do not fit a float"
    assert joints["velocity_rad_s"].iloc[0] == 2.0
    assert joints["torque_Nm"].iloc[0] == 0.09 + 0.08
    state = bag.table("controller_state")
    assert set(state["mode"]) == {0, 1}
    assert state["saturated"].dtype == bool
    assert "VELOCITY" not in state
    estimate = bag.table("friction_estimate")
    assert set(estimate["model"]) == {"lugre"}
    assert bag.types["/friction_estimate"] == "friction_msgs/msg/FrictionEstimate"
    health = bag.table("diagnostics").iloc[0]
    assert health["rig_driver/overruns"] == 3.0
    assert health["rig_driver/state"] == "active"
    assert health["rig_driver/level"] == 1


def test_part_of_a_bag_is_read_by_topic_and_time(known):
    bag = read_bag(known.plain, ["/motor_voltage"], start_s=1.0, stop_s=1.5)
    assert list(bag.topics) == ["/motor_voltage"]
    voltage = bag.table("motor_voltage")["voltage_V"]
    assert voltage.iloc[0] == 500.0, "the index counts from the bag's start, not the part's"
    assert voltage.index[0] == pytest.approx(1.0)
    assert voltage.index[-1] < 1.5 + 1e-9


def test_axes_are_told_apart_by_namespace(known):
    assert topic_name("joint_states", "/axis_1/") == "/axis_1/joint_states"
    bag = read_bag(known.named)
    assert len(bag.table("joint_states", "axis_1")) == 2000
    with pytest.raises(BagError, match="/axis_1/joint_states"):
        bag.table("joint_states")


def test_what_is_no_bag_is_told(known, tmp_path):
    with pytest.raises(BagError, match="nowhere does not exist"):
        read_bag(tmp_path / "nowhere")
    with pytest.raises(BagError, match=r"has no metadata\.yaml"):
        read_bag(tmp_path)
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(next(known.plain.glob("*.mcap")).read_bytes()[:5000])
    with pytest.raises(BagError, match="cannot be read as a bag"):
        read_bag(cut)
    with pytest.raises(BagError, match=r"none of /odom; it has .*/joint_states"):
        read_bag(known.plain, ["/odom"])


def test_the_common_table_has_gaps_where_nothing_was_recorded(known, tmp_path):
    table = read_table(known.plain)
    assert len(table) == 2000
    assert table["voltage_V"].isna().sum() == 1000
    assert table["estimated_torque_Nm"].iloc[0] == pytest.approx(0.16)
    file = tmp_path / "table.csv"
    assert main([str(known.plain), str(file)]) == 0
    lines = file.read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("t_s,position_rad,velocity_rad_s,torque_Nm,voltage_V,estimated_torque_Nm")
    assert lines[2].startswith("0.002,")
    assert len(lines) == 2001


def test_a_wrong_bag_ends_the_command_with_a_sentence(tmp_path, capsys):
    assert main([str(tmp_path / "nowhere"), str(tmp_path / "t.csv")]) == 2
    assert "nowhere does not exist" in capsys.readouterr().err
    assert not (tmp_path / "t.csv").exists()


def test_a_bag_of_the_laboratory_has_every_cycle(laboratory_bag):
    bag = read_bag(laboratory_bag, stop_s=3.0)
    topics = ("joint_states", "rig_measurement", "reference", "motor_voltage", "friction_estimate", "controller_state")
    lengths = {len(bag.table(name)) for name in topics}
    assert len(lengths) == 1
    rig, joints = bag.table("rig_measurement"), bag.table("joint_states")
    assert (rig["tachometer_velocity_rad_s"] == joints["velocity_rad_s"]).all()
    assert (joints["stamp_ns"] - bag.start_ns == np.round(joints.index * 1e9)).all(), "log time is the sample's own"
