"""Tables from views of the bytes are those of messages read one by one."""

import numpy as np
import pandas as pd
import pytest
from conftest import START, store
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import get_types_from_msg

from friction_analysis import BagError, read_bag
from friction_analysis.cdr_views import NoView, layouts
from friction_analysis.views import ViewedTable

ODD = """
std_msgs/Header header
bool flag
uint8[3] bytes
int16 small
uint64 large
float32 single
string text
float32[] values
geometry_msgs/Vector3 where
geometry_msgs/Vector3[] more
string[] names
"""


def assert_same(bag):
    viewed, single = read_bag(bag), read_bag(bag, one_by_one=True)
    assert viewed.topics.keys() == single.topics.keys() and viewed.types == single.types
    for topic, table in single.topics.items():
        pd.testing.assert_frame_equal(viewed.topics[topic], table, check_exact=True, obj=topic)
    part, same = read_bag(bag, start_s=0.3, stop_s=1.1), read_bag(bag, start_s=0.3, stop_s=1.1, one_by_one=True)
    assert part.topics.keys() == same.topics.keys()
    for topic, table in same.topics.items():
        pd.testing.assert_frame_equal(part.topics[topic], table, check_exact=True, obj=topic)


def write_odd(path, plugin=StoragePlugin.MCAP, compression=None, big_endian=False):
    """Everything that a layout may hold, lengths that change from message to message, times out of order."""
    types = store()
    types.register(get_types_from_msg(ODD, "odd_msgs/msg/Odd"))
    kinds = types.types
    header, time, vector = kinds["std_msgs/msg/Header"], kinds["builtin_interfaces/msg/Time"], kinds["geometry_msgs/msg/Vector3"]
    writer = Writer(path, version=9, storage_plugin=plugin)
    if compression:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        odd = writer.add_connection("/odd", "odd_msgs/msg/Odd", typestore=types)
        joints = writer.add_connection("/joints", "sensor_msgs/msg/JointState", typestore=types)
        text = writer.add_connection("/text", "std_msgs/msg/String", typestore=types)
        for n in range(400):
            stamp = START + (n ^ 1) * 5_000_000
            head = header(time(stamp // 10**9, stamp % 10**9), "äxis"[: n % 3])
            message = kinds["odd_msgs/msg/Odd"](
                header=head,
                flag=bool(n % 3),
                bytes=np.array([n % 256, 1, 2], np.uint8),
                small=-n,
                large=2**63 + n if n % 50 == 0 else n,
                single=0.1 * n,
                text=f"{n % 4}" * (n % 5),
                values=np.arange(n % 3, dtype=np.float32),
                where=vector(1.0 * n, 2.0, float("nan")),
                more=[vector(0.5, 1.5, 2.5)] * (n // 200),
                names=["a", f"b{n % 2}"],
            )
            little = not (big_endian and n % 2)
            writer.write(odd, stamp, types.serialize_cdr(message, "odd_msgs/msg/Odd", little_endian=little))
            count = 1 if n < 300 else 2
            joint = kinds["sensor_msgs/msg/JointState"](
                header=head,
                name=["left", "right"][:count],
                position=np.full(count, 0.1 * n),
                velocity=np.full(count if n > 100 else 0, 1.0),
                effort=np.arange(count) * 1.0,
            )
            writer.write(joints, stamp, types.serialize_cdr(joint, "sensor_msgs/msg/JointState"))
            if n % 7 == 0:
                said = kinds["std_msgs/msg/String"](data="ü" * (n // 7))
                writer.write(text, stamp, types.serialize_cdr(said, "std_msgs/msg/String"))


def test_views_are_the_messages(known):
    assert_same(known.plain)
    assert_same(next(known.plain.glob("*.mcap")))


@pytest.mark.parametrize("big_endian", [False, True])
def test_lengths_that_change_and_every_kind_of_value_are_the_same(tmp_path, big_endian):
    write_odd(tmp_path / "bag", big_endian=big_endian)
    assert_same(tmp_path / "bag")
    names = read_bag(tmp_path / "bag").table("joints").columns
    assert {"position_rad", "left.position_rad", "right.torque_Nm"} <= set(names)


@pytest.mark.parametrize("compression", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_what_has_no_views_is_read_one_by_one(tmp_path, compression):
    write_odd(tmp_path / "compressed", StoragePlugin.SQLITE3, compression)
    write_odd(tmp_path / "plain", StoragePlugin.SQLITE3)
    for bag in (tmp_path / "compressed", tmp_path / "plain"):
        assert len(read_bag(bag).table("odd")) == 400


def test_the_laboratorys_own_bag_is_the_same(laboratory_bag):
    assert_same(laboratory_bag)


def test_numbers_of_the_laboratory_need_no_reading_one_by_one(laboratory_bag, monkeypatch):
    """What is slow is not used: the measure of it is in README.md."""
    monkeypatch.setattr("friction_analysis.bag.Rows.add", lambda *_: pytest.fail("a message was read by itself"))
    assert len(read_bag(laboratory_bag, ["/joint_states", "/controller_state", "/friction_estimate"]).topics) == 3


def test_a_message_that_does_not_fit_its_type_is_no_view(known):
    types = store()
    kind = "friction_msgs/msg/MotorVoltage"
    whole = np.zeros((2, 40), dtype=np.uint8)
    whole[:, 1] = 1
    for length in (3, 10, 39):
        with pytest.raises(NoView):
            layouts(whole[:, :length], kind, types)
    huge = whole.copy()
    huge[:, 12:16] = 255
    with pytest.raises(NoView):
        layouts(huge, kind, types)
    assert ViewedTable(kind, types).frame(0).empty


def test_damage_is_told_or_harmless(known, tmp_path):
    """Wherever bytes are wrong: a sentence, or the same table as one by one."""
    whole = next(known.plain.glob("*.mcap")).read_bytes()
    random = np.random.default_rng(3)
    told = 0
    for number in range(12):
        data = bytearray(whole)
        at = int(random.integers(100, len(data) - 100))
        data[at : at + 24] = random.bytes(24)
        file = tmp_path / f"damaged_{number}.mcap"
        file.write_bytes(data)
        try:
            viewed = read_bag(file)
        except BagError as error:
            told += 1
            assert "cannot be read as a bag" in str(error)
            continue
        single = read_bag(file, one_by_one=True)
        for topic, table in single.topics.items():
            pd.testing.assert_frame_equal(viewed.topics[topic], table, check_exact=True, obj=topic)
    assert told, "none of the damage was seen"
