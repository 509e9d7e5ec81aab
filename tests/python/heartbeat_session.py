"""A HEARTBEAT that announces billions of messages, in the name of a writer that the rig driver knows. usage: heartbeat_session.py FOLDER"""

import json
import socket
import struct
import sys
import time

from packets_session import caught, ports
from rig_bench import CONTROLLER, OBSERVER, PROGRAMS, RIG, Bench
from ros_calls import caller

HEARTBEAT = 0x07
BILLIONS = 200


def promising(packet):
    """The packet with every heartbeat in it announcing BILLIONS of 2^32 messages; none if there is no heartbeat in it."""
    data, at, found = bytearray(packet), 20, False
    while at + 4 <= len(data):
        order = "<" if data[at + 1] & 1 else ">"
        length = struct.unpack_from(order + "H", data, at + 2)[0]
        if data[at] == HEARTBEAT and length >= 28:
            found = True
            # Reader, writer, first and last number, each of two words, count.
            struct.pack_into(order + "i", data, at + 4 + 16, BILLIONS)
            struct.pack_into(order + "i", data, at + 4 + 24, 1_000_000_000)
        at += 4 + (length or len(data))
    return bytes(data) if found else None


def memory(pid):
    """Resident memory [GB]; none of a process that has ended."""
    try:
        with open(f"/proc/{pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * 4096e-9
    except (OSError, IndexError):
        return 0.0


def main() -> None:
    with caller(fast=True) as ros, Bench(ros, sys.argv[1]) as bench:
        bench.velocity = 1.0
        bench.start(*PROGRAMS)
        assert bench.moves(1.0, 30), "the loop does not close"
        rig = bench.running[RIG[1:]]
        packets = [packet for packet in (promising(packet) for _, packet in caught(ros, 1.0)) if packet]
        # Multicast ports are everybody's.
        targets = set(ports(rig.pid)).difference(*(ports(bench.running[node[1:]].pid) for node in (OBSERVER, CONTROLLER)))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            for packet in packets:
                for port in targets:
                    out.sendto(packet, ("127.0.0.1", port))
        highest, end = 0.0, time.monotonic() + 5
        while rig.poll() is None and time.monotonic() < end:
            ros.once(0.05)
            highest = max(highest, memory(rig.pid))
        report = {"heartbeats": len(packets), "gigabytes": highest, "moves": bench.moves(1.0, 20)}
        report["states"] = [ros.state(node) for node in (RIG, OBSERVER, CONTROLLER)]
        report["code"], _, report["said"] = bench.end(RIG[1:])
        print(json.dumps(report))


if __name__ == "__main__":
    main()
