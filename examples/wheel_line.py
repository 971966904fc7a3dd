#!/usr/bin/env python3
"""The motor controller's side of the wheel line (the book, Wheel line), as a reference for those who build one.

    python3 wheel_line.py vectors          prints the lines that the tests compare
    python3 wheel_line.py serve DEVICE     answers on a serial line or pseudo-terminal, with two ideal wheels

Needs nothing but Python.
"""

import binascii
import os
import select
import sys
import termios
import time
import tty

OFF, FOLLOWS, EXPIRED, FAULT = range(4)
TICKS_PER_MM = 10
RAMP_MMPS2 = 1400.0
REPORT_S = 0.02


def closed(text: str) -> bytes:
    """A line with its checksum: CRC-16 of polynomial 1021h that begins with FFFFh, over all before the star."""
    return b"%s*%04X\n" % (text.encode(), binascii.crc_hqx(text.encode(), 0xFFFF))


def opened(line: bytes):
    """The words of a line without its end, or None where it is damaged."""
    text, star, digits = line.rpartition(b"*")
    if not star or digits != b"%04X" % binascii.crc_hqx(text, 0xFFFF):
        return None
    return text.split(b" ")


def request(sequence, deadline_ms, follow, speeds_mmps) -> bytes:
    return closed(" ".join(map(str, ["W", sequence, deadline_ms, int(follow), *speeds_mmps])))


def report(sequence, heard, age_ms, state, wheels) -> bytes:
    values = [value for wheel in wheels for value in wheel]
    return closed(" ".join(map(str, ["M", sequence, heard, age_ms, state, *values])))


class Controller:
    """Takes requests, stops by itself after a deadline, and reports."""

    def __init__(self, wheels=2):
        self.target = [0.0] * wheels
        self.speed = [0.0] * wheels
        self.place_mm = [0.0] * wheels
        self.newest = None
        self.ends_s = 0.0
        self.follow = False
        self.reports = 0

    def take(self, line: bytes, now_s: float):
        words = opened(line)
        if not words or words[0] != b"W" or len(words) != 4 + len(self.target):
            return
        sequence, deadline_ms, follow, *speeds = map(int, words[1:])
        # A request that is not newer than the last one is not obeyed: it may have waited somewhere.
        if self.newest is not None and not 0 < (sequence - self.newest) % 2**32 < 2**31:
            return
        self.newest, self.follow = sequence, follow == 1
        self.ends_s, self.target = now_s + deadline_ms / 1e3, speeds

    def step(self, now_s: float, step_s: float):
        in_time = self.newest is not None and now_s < self.ends_s
        for wheel in range(len(self.speed)):
            target = self.target[wheel] if in_time and self.follow else 0.0
            change = RAMP_MMPS2 * step_s
            self.speed[wheel] += max(-change, min(change, target - self.speed[wheel]))
            self.place_mm[wheel] += self.speed[wheel] * step_s

    def report(self, now_s: float) -> bytes:
        self.reports = (self.reports + 1) % 2**32
        if self.newest is None or not self.follow:
            state = OFF
        else:
            state = FOLLOWS if now_s < self.ends_s else EXPIRED
        counts = [(int(place * TICKS_PER_MM) + 2**31) % 2**32 - 2**31 for place in self.place_mm]
        wheels = [(round(speed), count) for speed, count in zip(self.speed, counts)]
        return report(self.reports, self.newest or 0, 0, state, wheels)


def serve(device: str):
    line = os.open(device, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(line, termios.TCSANOW)
    controller, rest, last_s = Controller(), b"", time.monotonic()
    while True:
        if select.select([line], [], [], REPORT_S)[0]:
            rest += os.read(line, 256)
            *lines, rest = rest.split(b"\n")
            for text in lines:
                controller.take(text.rstrip(b"\r"), time.monotonic())
        now_s = time.monotonic()
        if now_s - last_s >= REPORT_S:
            controller.step(now_s, now_s - last_s)
            last_s = now_s
            os.write(line, controller.report(now_s))


def vectors():
    lines = [
        request(7, 100, True, [250, -250]),
        request(2**32 - 1, 65535, False, [0, 0, 0, 0]),
        report(12, 7, 3, EXPIRED, [(100, 2**31 - 1), (-100, -(2**31))]),
    ]
    sys.stdout.write("".join(line.decode() for line in lines))


if __name__ == "__main__":
    if sys.argv[1:] == ["vectors"]:
        vectors()
    elif len(sys.argv) == 3 and sys.argv[1] == "serve":
        serve(sys.argv[2])
    else:
        sys.exit(__doc__)
