"""Damaged DDS packets at the nodes' own ports. usage: packets_session.py FOLDER PACKETS SEED

Packets are caught on loopback, changed in a few bytes, cut or lengthened, and sent once more.
"""

import json
import os
import random
import socket
import struct
import sys
import time

from latecomers_session import newcomer
from rig_bench import CONTROLLER, OBSERVER, PROGRAMS, RIG, Bench
from ros_calls import caller


def caught(ros, seconds):
    """RTPS packets on loopback with the port they went to. Needs the right to open a raw socket."""
    packets = []
    with socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.ntohs(0x0800)) as wire:
        wire.bind(("lo", 0))
        wire.setblocking(False)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            ros.once(0.002)
            while True:
                try:
                    frame = wire.recv(65536)
                except BlockingIOError:
                    break
                header = 14 + (frame[14] & 15) * 4
                if frame[23] == 17 and frame[header + 8 : header + 12] == b"RTPS":
                    packets.append((struct.unpack("!H", frame[header + 2 : header + 4])[0], frame[header + 8 :]))
    return packets


def damaged(dice, packet):
    data = bytearray(packet)
    kind = dice.randrange(4)
    if kind == 0:
        return bytes(data[: dice.randrange(len(data))])
    if kind == 1:
        return bytes(data) + bytes(dice.randrange(256) for _ in range(dice.randrange(200)))
    for _ in range(dice.choice((1, 1, 2, 8, 40))):
        at = dice.randrange(20, len(data)) if len(data) > 20 else 0
        data[at] = dice.choice((0, 1, 0x7F, 0x80, 0xFF, dice.randrange(256)))
    return bytes(data)


def ports(pid):
    """UDP ports of a process."""
    inodes = set()
    for descriptor in os.listdir(f"/proc/{pid}/fd"):
        try:
            target = os.readlink(f"/proc/{pid}/fd/{descriptor}")
        except OSError:
            continue
        if target.startswith("socket:"):
            inodes.add(target[8:-1])
    found = set()
    with open(f"/proc/{pid}/net/udp", encoding="ascii") as table:
        for line in table.readlines()[1:]:
            fields = line.split()
            if fields[9] in inodes:
                found.add(int(fields[1].split(":")[1], 16))
    return sorted(found)


def main() -> None:
    folder, count, seed = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    dice = random.Random(seed)
    with caller(fast=True) as ros, Bench(ros, folder) as bench:
        bench.velocity = 0.0
        bench.start(*PROGRAMS)
        assert ros.until(lambda: len(bench.commands) > 300, 30), "the loop does not close"
        packets = caught(ros, 0.5)
        # Discovery once more: a participant that joins and leaves.
        packets += caught(ros, 1.0)
        distinct = {}
        for _, packet in packets:
            distinct.setdefault((len(packet), packet[20:21]), packet)
        sources = list(distinct.values()) + [packet for _, packet in dice.sample(packets, min(200, len(packets)))]
        targets = [port for name in PROGRAMS for port in ports(bench.running[name].pid)]
        bench.forget()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            for number in range(count):
                data = damaged(dice, dice.choice(sources))
                try:
                    out.sendto(data, ("127.0.0.1", dice.choice(targets)))
                except OSError:
                    pass
                if number % 20 == 0:
                    ros.spin(0.005)
        ros.spin(1.0)
        report = {
            "sources": len(sources),
            "targets": targets,
            "highest": max((abs(m.voltage_applied) for m in bench.measured), default=0.0),
            "alive": {name: bench.running[name].poll() is None for name in PROGRAMS},
        }
        # Packets in this participant's name may have spoiled what the nodes think of it: somebody else asks.
        report["states"] = []
        for node in (RIG, OBSERVER, CONTROLLER):
            try:
                report["states"].append(newcomer(lambda ros: ros.state(node))[0])
            except RuntimeError as error:
                report["states"].append(str(error))
        report["said"], report["exit"] = {}, []
        for name in PROGRAMS:
            code, took, said = bench.end(name)
            report["exit"].append([code, took])
            report["said"][name] = said[-6000:]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
