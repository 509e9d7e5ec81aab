"""A fleet in an object store, identified by a Ray cluster of three nodes that loses a worker and a node meanwhile.

`FLEET_RECORDINGS` says how many recordings there are. The test runs in a network namespace of its own; Ray and the
server of the store listen on its loopback alone.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pandas as pd
import pytest

ray = pytest.importorskip("ray")
s3fs = pytest.importorskip("s3fs")
pytest.importorskip("moto.server")

from frictionlab import BadInput, fleet
from frictionlab.fleet.search import search
from frictionlab.fleet.trial.made import recording

COUNT = int(os.environ.get("FLEET_RECORDINGS", "60"))
PROGRAM = os.environ.get("FRICTIONLAB_BIN")
NAMES = r"(?P<machine>arm[0-9]+)/(?P<time>[0-9]+)"


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """Recordings in a bucket: some poisoned, one twice. Gives what opens the store."""
    environment = {"AWS_ACCESS_KEY_ID": "tests", "AWS_SECRET_ACCESS_KEY": "tests", "AWS_DEFAULT_REGION": "us-east-1"}
    os.environ.update(environment)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    log = (tmp_path_factory.mktemp("moto") / "log").open("wb")
    server = subprocess.Popen([sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)], stdout=log, stderr=log)
    storage = {"endpoint_url": f"http://127.0.0.1:{port}"}
    try:
        for _ in range(600):
            with socket.socket() as tried:
                if tried.connect_ex(("127.0.0.1", port)) == 0:
                    break
            assert server.poll() is None
            time.sleep(0.1)
        files = s3fs.S3FileSystem(**storage)
        files.mkdir("fleet")
        contents = {f"fleet/arm{at % 20}/{1_700_000_000 + 3600 * at}.csv": recording(at, 0.1) for at in range(COUNT)}
        names = list(contents)
        contents[names[3]] = b"no,recording\n1,2\n"
        contents[names[5]] = contents[names[4]]
        files.pipe(contents)
        yield storage
    finally:
        server.kill()
        server.wait()
        log.close()


@pytest.fixture(scope="module")
def cluster():
    """Three nodes, each its own processes."""
    from ray.cluster_utils import Cluster

    memory = {"object_store_memory": 80_000_000}
    # A busy machine is late with its heartbeats, and workers are polite: no node but the killed one is to count as lost.
    patient = {"health_check_failure_threshold": 10, "health_check_timeout_ms": 30_000, "worker_niceness": 0}
    made = Cluster(
        initialize_head=True,
        connect=False,
        head_node_args={"num_cpus": 1, "include_dashboard": False, "_system_config": patient, **memory},
    )
    others = [made.add_node(num_cpus=1, **memory) for _ in range(2)]
    made.wait_for_nodes()
    ray.init(address=made.address, log_to_driver=False, logging_level="warning")
    yield made, others
    ray.shutdown()
    made.shutdown()


def parts(out):
    return {file.name: file.read_bytes() for file in sorted((out / "results").iterdir())}


def workers_of(node):
    """The processes of a node that identify recordings now."""
    found = []
    for process in node.all_processes["raylet"]:
        for task in Path(f"/proc/{process.process.pid}/task").iterdir():
            found += [int(pid) for pid in (task / "children").read_text().split()]
    return [pid for pid in found if b"ray::friction_fleet" in named(pid)]


def named(pid):
    """What a process calls itself; nothing where it has ended."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""


def test_a_lost_worker_and_a_lost_node_change_nothing(store, cluster, tmp_path):
    made, others = cluster
    lost = []

    def lose(count):
        if not lost and count.done >= COUNT // 4 and (busy := workers_of(others[0])):
            os.kill(busy[0], signal.SIGKILL)
            lost.append("worker")
        if len(lost) == 1 and count.done >= COUNT // 2:
            made.remove_node(others[1], allow_graceful=False)
            lost.append("node")

    asked = {"names": NAMES, "storage": store, "model": "coulomb_viscous"}
    began = time.monotonic()
    by_ray = fleet.run("s3://fleet", tmp_path / "ray", engine="ray", on_progress=lose, **asked)
    took = time.monotonic() - began
    assert lost == ["worker", "node"]
    began = time.monotonic()
    local = fleet.run("s3://fleet", tmp_path / "local", workers=2, **asked)
    print(json.dumps({"recordings": COUNT, "ray_s": took, "local_s": time.monotonic() - began}))
    assert parts(tmp_path / "ray") == parts(tmp_path / "local")
    rows = by_ray.to_pandas()
    assert rows["uri"].nunique() == COUNT and not rows.duplicated(["uri", "joint", "model", "parameter"]).any()
    assert len(by_ray.failed) == 2
    assert by_ray.to_html() == local.to_html()


@pytest.mark.skipif(not PROGRAM, reason="FRICTIONLAB_BIN names no program")
def test_a_search_that_loses_a_worker_finds_what_one_process_finds(cluster, tmp_path):
    _, others = cluster
    lost = []

    def lose(count):
        if not lost and (busy := workers_of(others[0])):
            os.kill(busy[0], signal.SIGKILL)
            lost.append("worker")

    command = [PROGRAM, "monte-carlo", "--task", "position-tracking", "--draws", "12", "--means", "feedback"]
    alone = tmp_path / "alone"
    subprocess.run([*command, "--out", alone, "--quiet"], check=True)
    found = search(command, tmp_path / "out", shares=8, engine="ray", on_progress=lose)
    assert lost == ["worker"] and found.failed == []
    for name in ("monte-carlo.json", "report.html"):
        assert (found.out / name).read_bytes() == (alone / name).read_bytes()


def test_results_go_to_the_store_and_are_found_there(store, tmp_path):
    asked = {"names": NAMES, "storage": store, "model": "coulomb_viscous", "workers": 2}
    fleet.run("s3://fleet/arm1", "s3://fleet/results-of-arm1", **asked)
    done = []
    fleet.run("s3://fleet/arm1", "s3://fleet/results-of-arm1", on_progress=done.append, **asked)
    assert done == []
    assert len(fleet.read("s3://fleet/results-of-arm1", store).estimates) > 0


def test_a_store_that_refuses_is_told(store, tmp_path):
    with pytest.raises(BadInput, match="nowhere"):
        fleet.run("s3://nowhere/x", tmp_path / "out", storage=store)
    closed = {"endpoint_url": "http://127.0.0.1:9"}
    with pytest.raises(BadInput, match="cannot be listed"):
        fleet.run("s3://fleet", tmp_path / "out", storage=closed)
    # From here on the server looks at credentials: this is the last test.
    address = f"{store['endpoint_url']}/moto-api/reset-auth"
    urllib.request.urlopen(urllib.request.Request(address, data=b"0", headers={"Content-Type": "text/plain"}))
    with pytest.raises(BadInput, match="cannot be listed"):
        fleet.run("s3://fleet/arm1", tmp_path / "out", storage=store)
    asked = pd.DataFrame({"uri": ["s3://fleet/arm1/1700003600.csv"], "stamp": ["unknown"]})
    found = fleet.run(asked, tmp_path / "out", storage=store, model="coulomb_viscous", workers=1)
    assert "not allowed" in found.failed["error"].iloc[0] and "credentials" in found.failed["error"].iloc[0]
