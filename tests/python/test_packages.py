"""package.xml of every ROS package against Cargo.toml, and against the rules of format 3 (REP 149)."""

import json
import os
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CRATES = ["rig_driver", "friction_observer", "controller", "experiment_runner"]
OTHERS = ["launch_configs", "msgs/friction_msgs"]
# The elements of a package in the order that the schema of format 3 asks for.
ORDER = ["name", "version", "description", "maintainer", "license", "url", "author"]


@pytest.fixture(scope="session")
def crates():
    """What cargo knows of the workspace's packages."""
    cargo = os.environ.get("CARGO", "cargo")
    command = [cargo, "metadata", "--no-deps", "--offline", "--format-version", "1"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
    return {package["name"]: package for package in json.loads(told)["packages"]}


def package(folder):
    return ElementTree.parse(ROOT / folder / "package.xml").getroot()


def texts(root, tag):
    return [entry.text for entry in root.findall(tag)]


@pytest.mark.parametrize("folder", CRATES + OTHERS)
def test_a_package_is_complete_and_in_order(folder):
    root = package(folder)
    assert (root.tag, root.get("format")) == ("package", "3")
    head = [entry.tag for entry in root if entry.tag in ORDER]
    assert head == sorted(head, key=ORDER.index)
    assert re.fullmatch(r"[a-z][a-z0-9_]+", texts(root, "name")[0])
    assert re.fullmatch(r"\d+\.\d+\.\d+", texts(root, "version")[0])
    assert re.fullmatch(r"[^@\s]+@[^@\s]+\.[a-z]+", root.find("maintainer").get("email"))
    assert texts(root, "license") == ["MIT", "Apache-2.0"]
    kind = texts(root, "export/build_type")
    assert kind == (["ament_cargo"] if folder in CRATES else ["ament_cmake"])
    assert kind[0] in texts(root, "buildtool_depend")


@pytest.mark.parametrize("name", CRATES)
def test_a_crates_package_says_what_its_cargo_toml_says(name, crates):
    root, crate = package(name), crates[name]
    assert texts(root, "name") == [name]
    assert texts(root, "version") == [crate["version"]]
    assert texts(root, "description") == [crate["description"]]
    assert " OR ".join(texts(root, "license")) == crate["license"]
    # Of the crates of this workspace only nodes are ROS packages; cargo finds the others by their paths.
    normal = {dependency["name"] for dependency in crate["dependencies"] if dependency["kind"] is None}
    assert set(texts(root, "depend")) == normal & set(CRATES)
    # Tools show our messages with the package of their definitions.
    assert texts(root, "exec_depend") == ["friction_msgs"]


@pytest.mark.parametrize("name", CRATES)
def test_a_crate_has_the_executable_that_the_launch_files_start(name, crates):
    programs = [target["name"] for target in crates[name]["targets"] if "bin" in target["kind"]]
    if name not in programs:
        pytest.skip(f"{name} has no executable of its name yet")
    assert name in programs


def test_all_packages_have_one_version():
    assert len({texts(package(folder), "version")[0] for folder in CRATES + OTHERS}) == 1
