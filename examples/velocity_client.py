#!/usr/bin/env python3
"""Drives a robot that floorguard guards: sends velocities, prints what is permitted and why not more.

By a script of steps, each FORWARD_MPS,TURN_RADPS,SECONDS:

    python3 velocity_client.py --to 127.0.0.1:7000 --script "0.5,0,10 0,0.3,5"

By the keyboard (w, s faster and slower, a, d left and right, space stands, q ends):

    python3 velocity_client.py --to 127.0.0.1:7000

The format stands in the book, "Velocity link". Python's standard library is all it needs.
"""

import argparse
import select
import socket
import struct
import sys
import time
import zlib

STATES = ["init", "run", "slow", "stop", "latched", "awaits start"]
REQUEST = struct.Struct("<2sBBIIIHBBff")
PERIOD_S = 0.05


def request(sender, sequence, deadline_ms, forward_mps, turn_radps):
    """The bytes of a request."""
    sent_ms = int(time.monotonic() * 1000) & 0xFFFFFFFF
    body = REQUEST.pack(
        b"FG", 1, 1, sender, sequence & 0xFFFFFFFF, sent_ms, deadline_ms, 0, 0, forward_mps, turn_radps
    )
    return body + struct.pack("<I", zlib.crc32(body))


def read_permit(data):
    """The fields of a permit, or None if the bytes are none."""
    if len(data) != 236 or data[:4] != b"FG\x01\x02":
        return None
    if zlib.crc32(data[:-4]) != struct.unpack_from("<I", data, 232)[0]:
        return None
    floats = struct.unpack_from("<7f", data, 24)
    counters = struct.unpack_from("<7I", data, 76)
    return {
        "sender": struct.unpack_from("<I", data, 4)[0],
        "acknowledged": struct.unpack_from("<I", data, 12)[0],
        "permitted": floats[0:2],
        "requested": floats[2:4],
        "measured": floats[4:6],
        "limit_mps": floats[6],
        "state": STATES[data[52]] if data[52] < len(STATES) else str(data[52]),
        "expired": bool(data[54] & 8),
        "refused": sum(counters[1:]),
        "reason": data[104 : 104 + data[73]].decode(errors="replace"),
    }


def line_of(permit):
    """A permit in one line."""
    return "{state:12} permitted {:5.2f} m/s {:5.2f} rad/s, measured {:5.2f} m/s, limit {limit:.2f} m/s{}{}".format(
        *permit["permitted"],
        permit["measured"][0],
        ", refused %d" % permit["refused"] if permit["refused"] else "",
        ": " + permit["reason"] if permit["reason"] else "",
        state=permit["state"],
        limit=permit["limit_mps"],
    )


class Keys:
    """The keyboard as a pair of velocities."""

    def __init__(self):
        import termios
        import tty

        self.before = termios.tcgetattr(sys.stdin)
        self.termios = termios
        tty.setcbreak(sys.stdin.fileno())
        self.forward_mps, self.turn_radps = 0.0, 0.0

    def velocity(self, _elapsed_s):
        while select.select([sys.stdin], [], [], 0)[0]:
            key = sys.stdin.read(1)
            if key == "q":
                return None
            self.forward_mps += {"w": 0.1, "s": -0.1}.get(key, 0.0)
            self.turn_radps += {"a": 0.1, "d": -0.1}.get(key, 0.0)
            if key == " ":
                self.forward_mps, self.turn_radps = 0.0, 0.0
        return self.forward_mps, self.turn_radps

    def close(self):
        self.termios.tcsetattr(sys.stdin, self.termios.TCSADRAIN, self.before)


class Script:
    """Steps one after the other."""

    def __init__(self, text):
        self.steps = [tuple(float(number) for number in step.split(",")) for step in text.split()]

    def velocity(self, elapsed_s):
        for forward_mps, turn_radps, seconds in self.steps:
            if elapsed_s < seconds:
                return forward_mps, turn_radps
            elapsed_s -= seconds
        return None

    def close(self):
        pass


def address(text):
    host, port = text.rsplit(":", 1)
    return host, int(port)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--to", type=address, default=("127.0.0.1", 7000), metavar="ADDRESS:PORT")
    parser.add_argument("--script", metavar="STEPS", help="FORWARD_MPS,TURN_RADPS,SECONDS and so on; without it the keyboard")
    parser.add_argument("--sender", type=int, default=7)
    parser.add_argument("--deadline-ms", type=int, default=150)
    parser.add_argument("--wait-s", type=float, default=20.0, help="for the first permit that lets the robot move")
    arguments = parser.parse_args()
    link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    link.setblocking(False)
    driver = Script(arguments.script) if arguments.script else Keys()
    sequence, began, ready_at, shown, newest = 0, time.monotonic(), None, None, None
    try:
        while True:
            now = time.monotonic()
            velocity = driver.velocity(now - ready_at) if ready_at else (0.0, 0.0)
            if velocity is None:
                break
            sequence += 1
            link.sendto(request(arguments.sender, sequence, arguments.deadline_ms, *velocity), arguments.to)
            while select.select([link], [], [], max(0.0, now + PERIOD_S - time.monotonic()))[0]:
                try:
                    newest = read_permit(link.recv(512)) or newest
                except OSError:
                    pass  # the robot does not listen yet
            if newest and newest["state"] in ("run", "slow") and ready_at is None:
                ready_at = time.monotonic()
            if ready_at is None and now - began > arguments.wait_s:
                print("the robot does not become ready:", newest and line_of(newest), file=sys.stderr)
                return 1
            key = newest and (newest["state"], newest["reason"].split(":")[0])
            if newest and (key != shown or sequence % 20 == 0):
                shown = key
                print(line_of(newest), flush=True)
    finally:
        driver.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
