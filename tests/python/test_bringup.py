"""The package friction_bringup: launch files run against a stand-in of `launch`, parameter files and layouts checked against the project."""

import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import launch_real
import pytest
import yaml
from launch_stub import Node, Shutdown, launch

ROOT = Path(__file__).resolve().parents[2]
BRINGUP = ROOT / "launch_configs"
FRICTION = BRINGUP / "launch" / "friction.launch.py"
LIVE = BRINGUP / "launch" / "live.launch.py"
TWO = BRINGUP / "launch" / "two_axes.launch.py"
NODES = ["rig_driver", "friction_observer", "controller", "experiment_runner"]
JOINT_STATE = {"name": "string[]", "position": "float64[]", "velocity": "float64[]", "effort": "float64[]"}


def topics():
    """Topics of the laboratory with their message types, out of msgs/src/topics.rs."""
    text = (ROOT / "msgs/src/topics.rs").read_text(encoding="utf-8")
    return dict((name, kind) for kind, name in re.findall(r'Topic<(\w+)> =\s*Topic::new\(\s*"([^"]+)"', text))


def fields(kind):
    if kind == "JointState":
        return JOINT_STATE
    text = (ROOT / f"msgs/friction_msgs/msg/{kind}.msg").read_text(encoding="utf-8")
    return {name: of for of, name in re.findall(r"^([\w/\[\]]+) ([a-z]\w*)$", text, re.MULTILINE)}


def declared():
    """Parameters of each node with type and default, out of the tables in docs/reference/parameters.md, which are made from the code."""
    file = ROOT / "docs/reference/parameters.md"
    if not file.is_file():
        pytest.skip("docs/reference/parameters.md, the table of parameters, is not here")
    found, node = {}, None
    for line in file.read_text(encoding="utf-8").splitlines():
        if heading := re.match(r"##+ (\w+)$", line):
            node = heading.group(1)
        elif row := re.match(r"\| `([\w.]+)` \| ([\w ]+) \| (.*?) \|", line):
            if node in NODES:
                found.setdefault(node, {})[row.group(1)] = row.groups()[1:]
    return found


def flat(values, prefix=""):
    for name, value in values.items():
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def own_parameters(file):
    """The file's one node and its parameters."""
    content = yaml.safe_load(file.read_text(encoding="utf-8"))
    (key,) = content
    assert key.startswith("/**/"), f"{file}: keyed so that it holds in every namespace"
    assert list(content[key]) == ["ros__parameters"]
    return key.removeprefix("/**/"), dict(flat(content[key]["ros__parameters"]))


@pytest.mark.parametrize("file", sorted((BRINGUP / "launch").iterdir()), ids=lambda file: file.name)
def test_every_launch_file_runs_without_arguments_and_explains_those_it_takes(file):
    context = launch(file)
    assert context.started
    for name, argument in context.declared.items():
        assert argument.default_value is not None, name
        assert len(argument.description) > 10, name


def test_four_nodes_start_with_their_own_files_and_nothing_else_set():
    context = launch(FRICTION)
    assert [node.executable for node in context.started] == NODES
    for node in context.started:
        assert isinstance(node, Node)
        assert (node.package, node.name, node.namespace) == ("friction_nodes", node.executable, "")
        assert node.parameters == [str(BRINGUP / "config" / f"{node.executable}.yaml")]
        assert Path(node.parameters[0]).is_file()
        assert own_parameters(Path(node.parameters[0]))[0] == node.executable
        assert isinstance(node.on_exit, Shutdown) == (node.executable != "experiment_runner")


def test_arguments_come_after_the_files_and_reach_the_nodes_they_concern(tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text("/friction_observer: {ros__parameters: {model: dahl}}")
    given = {"rig": "serial:/dev/ttyACM0@115200", "model": "lugre", "mode": "position", "namespace": "axis_1"}
    context = launch(FRICTION, params_file=str(file), **given)
    sets = {node.executable: node.parameters[2:] for node in context.started}
    assert sets == {
        "rig_driver": [{"rig": given["rig"]}],
        "friction_observer": [{"model": "lugre", "mode": "position"}],
        "controller": [{"mode": "position"}],
        "experiment_runner": [{"rig": "nodes"}],
    }
    assert launch(FRICTION, rig="simulated").started[3].parameters[1:] == [], "experiments need no real time there"
    assert all(node.parameters[1] == str(file) and node.namespace == "axis_1" for node in context.started)


def test_executables_of_the_path_get_the_same_as_ros_arguments(tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text("{}")
    context = launch(FRICTION, executables="path", namespace="axis_1", model="lugre", params_file=str(file), log_level="debug")
    observer = context.started[1]
    assert not isinstance(observer, Node)
    own = str(BRINGUP / "config" / "friction_observer.yaml")
    assert observer.cmd == [
        *["friction_observer", "--ros-args", "--log-level", "debug", "-r", "__ns:=/axis_1"],
        *["--params-file", own, "--params-file", str(file), "-p", "model:=lugre"],
    ]


def test_the_recorder_starts_first_and_takes_every_topic_of_the_laboratory(tmp_path):
    bag = tmp_path / "bag"
    command = launch(FRICTION, record=str(bag)).started[0].cmd
    assert command[:3] == ["ros2", "bag", "record"]
    assert command[command.index("--output") + 1] == str(bag)
    assert set(command[command.index("--topics") + 1 :]) == set(topics()) - {"/clock", "/rosout"}
    named = launch(FRICTION, record=str(bag), namespace="axis_2").started[0].cmd
    assert "/axis_2/joint_states" in named and "/diagnostics" in named


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"rig": "seriel:/dev/ttyACM0"}, "expected simulated, serial:PORT"),
        ({"rig": "serial:"}, "expected simulated, serial:PORT"),
        ({"mode": "torque"}, "expected velocity, position"),
        ({"params_file": "/nowhere.yaml"}, "/nowhere.yaml is no file"),
        ({"record": str(ROOT)}, "exists already"),
        ({"executables": "docker"}, "expected packages, path"),
        ({"log_level": "loud"}, "expected debug"),
    ],
)
def test_what_no_node_could_mean_is_refused_before_anything_starts(given, said):
    with pytest.raises(RuntimeError, match=re.escape(said)):
        launch(FRICTION, **given)


def test_two_axes_differ_in_namespace_rig_and_files():
    context = launch(TWO, rig_2="serial:/dev/ttyACM1", model_1="gms")
    assert [node.namespace for node in context.started] == ["axis_1"] * 4 + ["axis_2"] * 4
    drivers = [node for node in context.started if node.executable == "rig_driver"]
    assert drivers[0].parameters[-1] == {"rig": "simulated"}
    assert drivers[1].parameters[1:] == [str(BRINGUP / "config" / "axis_2.yaml"), {"rig": "serial:/dev/ttyACM1"}]
    observers = [node for node in context.started if node.executable == "friction_observer"]
    assert observers[0].parameters[-1] == {"model": "gms"}
    assert all("model" not in part for part in observers[1].parameters if isinstance(part, dict))


def test_live_puts_arguments_before_its_file_and_knows_only_options_of_the_program():
    (process,) = launch(LIVE).started
    expected = ["--rig", "simulated", "--model", "proposed", "--mode", "velocity", "--seed", "1"]
    assert process.cmd == ["frictionlab", "live", *expected]
    (process,) = launch(LIVE, model="lugre", serve="true", no_compensation="false", duration="5").started
    assert process.cmd[process.cmd.index("--model") + 1] == "lugre"
    assert process.cmd[-1] == "--serve"
    with pytest.raises(RuntimeError, match="expected true or false"):
        launch(LIVE, serve="perhaps")


def test_live_refuses_a_file_with_unknown_settings(tmp_path):
    file = tmp_path / "live.yaml"
    file.write_text("modle: lugre")
    with pytest.raises(RuntimeError, match="modle; expected only rig, model"):
        launch(LIVE, config=str(file))


@pytest.mark.parametrize("option", ["rig", "model", "mode", "parameters", "duration", "seed", "out", "serve", "no_compensation"])
def test_every_option_of_live_exists_in_the_program(option):
    # The folder's option is that of every command.
    files = ["frictionlab/src/cli/live.rs", "work/src/destination.rs"]
    source = "".join((ROOT / name).read_text(encoding="utf-8") for name in files)
    there = re.search(rf"^    pub {option}: ", source, re.MULTILINE)
    if option == "serve" and not there:
        pytest.skip("this frictionlab live has no --serve")
    assert there


@pytest.mark.parametrize("name", [*NODES, "axis_2"])
def test_parameter_files_name_only_parameters_that_the_node_declares(name):
    node, values = own_parameters(BRINGUP / "config" / f"{name}.yaml")
    assert values
    known = declared()[node]
    kinds = {bool: "bool", int: "integer", float: "double", str: "string"}
    for parameter, value in values.items():
        assert parameter in known, f"{node} has no parameter {parameter}"
        kind, default = known[parameter]
        assert kind == kinds[type(value)], parameter
        # What our files say is what holds without them, but for the second axis.
        if name != "axis_2":
            assert str(value).lower() == default.lower(), parameter


def foxglove_paths(value):
    """Message paths and topics of a panel's configuration."""
    for key, entry in value.items():
        if key == "paths":
            yield from (path["value"] for path in entry)
        elif key == "xAxisPath":
            yield entry["value"]
        elif key in ("topicPath", "topicToRender"):
            yield entry


def test_the_foxglove_layout_shows_each_panel_once_and_only_what_is_published():
    document = json.loads((BRINGUP / "layouts/foxglove.json").read_text(encoding="utf-8"))
    assert set(document) == {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"}
    shown = []

    def walk(part):
        if isinstance(part, str):
            shown.append(part)
        else:
            assert set(part) == {"direction", "first", "second", "splitPercentage"}
            assert part["direction"] in ("row", "column")
            walk(part["first"])
            walk(part["second"])

    walk(document["layout"])
    assert sorted(shown) == sorted(document["configById"])
    known = topics()
    for panel, configuration in document["configById"].items():
        assert panel.split("!")[0] in ("Plot", "DiagnosticSummary", "RawMessages", "CallService"), panel
        for path in foxglove_paths(configuration):
            topic, _, rest = path.partition(".")
            assert topic in known, f"{panel}: {path}"
            if rest:
                name, array = re.fullmatch(r"(\w+)(\[0\])?", rest).groups()
                kind = fields(known[topic])[name]
                assert kind.startswith("float64") and kind.endswith("[]") == bool(array), path
    assert document["configById"]["CallService!stop"]["serviceName"] == "/rig_driver/emergency_stop"


def test_the_plotjuggler_layout_plots_only_what_is_published():
    root = ElementTree.parse(BRINGUP / "layouts/plotjuggler.xml").getroot()
    assert root.tag == "root"
    tabs = root.findall("tabbed_widget/Tab")
    assert [tab.get("tab_name") for tab in tabs] == ["Tracking", "Friction", "Command"]
    for splitter in root.iter("DockSplitter"):
        assert int(splitter.get("count")) == len(splitter) == len(splitter.get("sizes").split(";"))
    known = topics()
    names = []
    for plot in root.iter("plot"):
        for curve in plot.findall("curve"):
            xy = plot.get("mode") == "XYPlot"
            names += [curve.get("curve_x"), curve.get("curve_y")] if xy else [curve.get("name")]
    assert len(names) > 10
    for name in names:
        topic, *rest = name[1:].split("/")
        kind = known[f"/{topic}"]
        # PlotJuggler sorts joint states by the joint's name.
        field = rest[1] if kind == "JointState" else rest[0]
        assert kind != "JointState" or rest[0] == "load_shaft", name
        assert fields(kind)[field].startswith("float64"), name


def test_everything_that_the_package_has_is_installed_and_depended_on():
    cmake = (BRINGUP / "CMakeLists.txt").read_text(encoding="utf-8")
    folders = re.search(r"install\(DIRECTORY ([\w ]+) DESTINATION", cmake).group(1).split()
    assert sorted(folders) == sorted(path.name for path in BRINGUP.iterdir() if path.is_dir() and path.name != "__pycache__")
    package = ElementTree.parse(BRINGUP / "package.xml").getroot()
    depends = {entry.text for entry in package.findall("exec_depend")}
    started = {node.package for node in launch(FRICTION).started}
    assert started == {"friction_nodes"}
    assert started | {"friction_msgs", "launch", "launch_ros", "python3-yaml", "ros2bag", "ros2launch", "rosbag2_storage_mcap"} == depends


@pytest.mark.parametrize(
    ("file", "given"),
    [
        (FRICTION, {}),
        (FRICTION, {"rig": "serial:/dev/ttyACM0@115200", "mode": "position", "model": "gms", "log_level": "debug"}),
        (FRICTION, {"namespace": "axis_1", "params_file": str(BRINGUP / "config/axis_2.yaml")}),
        (FRICTION, {"executables": "path", "namespace": "axis_1", "model": "lugre"}),
        (TWO, {"rig_2": "serial:/dev/ttyACM1", "model_1": "gms"}),
        (LIVE, {"model": "lugre", "serve": "true"}),
    ],
)
def test_the_real_launch_starts_what_the_stand_in_says(file, given, tmp_path, monkeypatch):
    if not launch_real.installed():
        pytest.skip("no `launch` and `launch_ros`: they come with a ROS installation, PyPI does not have them")
    folder = launch_real.prefix(tmp_path, "friction_nodes", [*NODES, "frictionlab"])
    monkeypatch.setenv("AMENT_PREFIX_PATH", launch_real.environment(folder, "friction_nodes")["AMENT_PREFIX_PATH"])
    ours = [process.command() if isinstance(process, Node) else process.cmd for process in launch(file, **given).started]
    theirs = launch_real.launch(file, folder, "friction_nodes", len(ours), **given)
    by_words = lambda meanings: sorted(meanings, key=repr)
    assert by_words(launch_real.meaning(told["words"]) for told in theirs) == by_words(map(launch_real.meaning, ours))
    for told in theirs:
        assert (told["FRICTION_LAUNCHED"], told["stdin_is_held"]) == ("until-stdin-ends", True), told["words"]
