"""Heartbeats that announce billions of messages, and fragments of samples that are gigabytes long, for `frictionlab live`.
usage: live_attacked_session.py FOLDER FRICTIONLAB ATTACK [interrupted]

The packets are made in the names of the writers that live knows: those of a controller beside it.
"""

import json
import os
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

from heartbeat_session import memory
from packets_session import ports

DATA, DATA_FRAG, HEARTBEAT = 0x15, 0x16, 0x07


def writers(seconds):
    """Participants on loopback, and their writers."""
    found = set()
    with socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.ntohs(0x0800)) as wire:
        wire.bind(("lo", 0))
        wire.settimeout(0.05)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                frame = wire.recv(65536)
            except OSError:
                continue
            packet = frame[14 + (frame[14] & 15) * 4 + 8 :]
            if frame[23] != 17 or packet[:4] != b"RTPS":
                continue
            at = 20
            while at + 4 <= len(packet):
                length = struct.unpack_from("<H", packet, at + 2)[0]
                begin = at + {DATA: 12, HEARTBEAT: 8}.get(packet[at], len(packet))
                if begin + 4 <= len(packet):
                    found.add((packet[8:20], packet[begin : begin + 4]))
                at += 4 + (length or len(packet))
    return sorted(found)


def heartbeat(dice, writer):
    numbers = struct.pack("<iIiII", 0, 1, 200, 1_000_000_000, dice.randrange(1, 1 << 31))
    return bytes((HEARTBEAT, 1, 28, 0, 0, 0, 0, 0)) + writer + numbers


def fragment(dice, writer):
    size = dice.choice((1 << 20, 1 << 28, 1 << 30, (1 << 32) - 1))
    head = struct.pack("<BBHHH4x", DATA_FRAG, 1, 32 + 1024, 0, 28)
    numbers = struct.pack("<iIIHHI", 0, dice.randrange(1, 100_000), dice.randrange(1, 1000), 1, 1024, size)
    return head + writer + numbers + bytes(1024)


def main() -> None:
    folder, frictionlab, attack = sys.argv[1:4]
    forge = {"heartbeats": heartbeat, "fragments": fragment}[attack]
    dice = random.Random(6)
    with tempfile.TemporaryDirectory() as out:
        live = subprocess.Popen(
            [frictionlab, "live", "--out", os.path.join(out, "live")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
        )
        beside = None
        try:
            begun = time.monotonic()
            while len(ports(live.pid)) < 5 and time.monotonic() < begun + 30:
                time.sleep(0.05)
            targets = ports(live.pid)
            beside = subprocess.Popen([os.path.join(folder, "controller")], stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
            known = writers(6.0)
            interrupted = "interrupted" in sys.argv
            if interrupted:
                live.send_signal(signal.SIGINT)
            began, highest = time.monotonic(), 0.0
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
                for _ in range(2000):
                    prefix, writer = dice.choice(known)
                    for port in targets:
                        try:
                            out.sendto(b"RTPS\x02\x04\x01\x12" + prefix + forge(dice, writer), ("127.0.0.1", port))
                        except OSError:
                            pass
            while not interrupted and live.poll() is None and time.monotonic() < began + 5:
                highest = max(highest, memory(live.pid))
                time.sleep(0.02)
            report = {"writers": len(known), "went_on": interrupted or live.poll() is None}
            if not interrupted:
                live.send_signal(signal.SIGINT)
            while live.poll() is None and time.monotonic() < began + 60:
                highest = max(highest, memory(live.pid))
                time.sleep(0.02)
            report |= {"code": live.poll(), "took": time.monotonic() - began, "gigabytes": highest}
        finally:
            for process in filter(None, (live, beside)):
                process.kill()
        report["said"] = live.stdout.read().decode(errors="replace")[-4000:]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
