"""package.xml of every ROS package against Cargo.toml, and against the rules of format 3 (REP 149)."""

import json
import os
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# What colcon builds; the folder of the nodes is a package of its own, the others are links.
PACKAGES = sorted(folder.name for folder in (ROOT / "ros").iterdir())
NODES = ["rig_driver", "friction_observer", "controller", "experiment_runner"]
# The elements of a package in the order that the schema of format 3 asks for.
ORDER = ["name", "version", "description", "maintainer", "license", "url", "author"]


@pytest.fixture(scope="session")
def crates():
    """What cargo knows of the workspace's packages."""
    cargo = os.environ.get("CARGO", "cargo")
    command = [cargo, "metadata", "--no-deps", "--offline", "--format-version", "1"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
    return {package["name"]: package for package in json.loads(told)["packages"]}


def package(name):
    return ElementTree.parse(ROOT / "ros" / name / "package.xml").getroot()


def texts(root, tag):
    return [entry.text for entry in root.findall(tag)]


@pytest.mark.parametrize("name", PACKAGES)
def test_a_package_is_complete_and_in_order(name, crates):
    root = package(name)
    assert (root.tag, root.get("format")) == ("package", "3")
    head = [entry.tag for entry in root if entry.tag in ORDER]
    assert head == sorted(head, key=ORDER.index)
    # Other packages of a workspace have other names.
    assert texts(root, "name") == [name] and re.fullmatch(r"friction_[a-z0-9_]+", name)
    assert len(texts(root, "description")[0]) > 20
    assert texts(root, "export/build_type") == ["ament_cmake"]
    assert "ament_cmake" in texts(root, "buildtool_depend")


@pytest.mark.parametrize("name", PACKAGES)
def test_a_package_says_of_itself_what_the_crates_say(name, crates):
    root = package(name)
    maintainer = root.find("maintainer")
    assert re.fullmatch(r"[^@\s]+@[^@\s]+\.[a-z]+", maintainer.get("email"))
    for crate in crates.values():
        assert texts(root, "version") == [crate["version"]]
        assert " OR ".join(texts(root, "license")) == crate["license"]
        assert [f"{maintainer.text} <{maintainer.get('email')}>"] == crate["authors"]
        assert crate["description"]


def test_the_nodes_package_has_the_programs_that_the_launch_files_start(crates):
    cmake = (ROOT / "ros/friction_nodes/CMakeLists.txt").read_text(encoding="utf-8")
    installed = re.search(r"set\(programs ([\w ]+)\)", cmake).group(1).split()
    assert installed == [*NODES, "frictionlab"]
    built = re.findall(r"--package (\w+)", cmake)
    programs = {target["name"] for name in built for target in crates[name]["targets"] if "bin" in target["kind"]}
    assert programs == set(installed)


def test_colcon_is_kept_from_every_crate(crates):
    # With colcon-cargo each would be a package of a name that others have too, such as `controller` or `msgs`.
    for crate in crates.values():
        folder = Path(crate["manifest_path"]).parent
        assert (folder / "COLCON_IGNORE").is_file(), f"{folder} lacks an empty file COLCON_IGNORE"
