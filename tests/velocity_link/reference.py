#!/usr/bin/env python3
"""Reference encoder of the velocity link, written from the book's byte tables alone (Velocity link).

It shares nothing with the Rust codec, with the simulator's encoder or with the example client: each byte is placed by hand at
its offset, and the checksum is computed bit by bit. Prints the book's test vectors: a name and the bytes as hexadecimal digits.
Standard library only. With `--decode HEX` it prints the fields of a permit instead.
"""

import struct
import sys


def crc32(data):
    """CRC-32: polynomial 04C11DB7h, reflected (EDB88320h), begins and ends inverted."""
    value = 0xFFFFFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value >> 1) ^ (0xEDB88320 if value & 1 else 0)
    return value ^ 0xFFFFFFFF


class Frame:
    """Bytes of a known length, all zero until a field is placed."""

    def __init__(self, kind, length):
        self.data = bytearray(length)
        self.place(0, "2s", b"FG")
        self.place(2, "B", 1)
        self.place(3, "B", kind)

    def place(self, offset, form, *values):
        struct.pack_into("<" + form, self.data, offset, *values)

    def finish(self):
        self.place(len(self.data) - 4, "I", crc32(self.data[:-4]))
        return bytes(self.data)


def request(sender, sequence, sent_ms, deadline_ms, stop, linear_mps, angular_radps):
    frame = Frame(1, 32)
    frame.place(4, "I", sender)
    frame.place(8, "I", sequence)
    frame.place(12, "I", sent_ms)
    frame.place(16, "H", deadline_ms)
    frame.place(18, "B", stop)
    frame.place(20, "f", linear_mps)
    frame.place(24, "f", angular_radps)
    return frame.finish()


def motion(sender, sequence, age_ms, state, code, linear_mps, angular_radps):
    frame = Frame(3, 32)
    frame.place(4, "I", sender)
    frame.place(8, "I", sequence)
    frame.place(12, "H", age_ms)
    frame.place(14, "B", state)
    frame.place(16, "H", code)
    frame.place(20, "f", linear_mps)
    frame.place(24, "f", angular_radps)
    return frame.finish()


# The permit's fields: name, offset, form.
PERMIT = [
    ("sender", 4, "I"),
    ("sequence", 8, "I"),
    ("acknowledged", 12, "I"),
    ("stamp_us", 16, "Q"),
    ("permitted_mps", 24, "f"),
    ("permitted_radps", 28, "f"),
    ("requested_mps", 32, "f"),
    ("requested_radps", 36, "f"),
    ("measured_mps", 40, "f"),
    ("measured_radps", 44, "f"),
    ("speed_limit_mps", 48, "f"),
    ("state", 52, "B"),
    ("action", 53, "B"),
    ("flags", 54, "B"),
    ("cause", 55, "B"),
    ("causes", 56, "Q"),
    ("value", 64, "f"),
    ("limit", 68, "f"),
    ("unit", 72, "B"),
    ("reason_length", 73, "B"),
    ("accepted", 76, "I"),
    ("damaged", 80, "I"),
    ("non_finite", 84, "I"),
    ("late", 88, "I"),
    ("out_of_order", 92, "I"),
    ("repeated", 96, "I"),
    ("other_sender", 100, "I"),
]


def permit(reason, **fields):
    frame = Frame(2, 236)
    text = reason.encode()
    fields["reason_length"] = len(text)
    for name, offset, form in PERMIT:
        frame.place(offset, form, fields.pop(name))
    assert not fields, fields
    frame.place(104, f"{len(text)}s", text)
    return frame.finish()


def decode_permit(data):
    assert len(data) == 236 and data[:4] == b"FG\x01\x02", data[:4]
    assert crc32(data[:-4]) == struct.unpack("<I", data[-4:])[0], "checksum"
    fields = {name: struct.unpack_from("<" + form, data, offset)[0] for name, offset, form in PERMIT}
    fields["reason"] = data[104 : 104 + fields["reason_length"]].decode()
    return fields


VECTORS = [
    ("request", request(7, 1, 5000, 150, 0, 0.5, -0.25)),
    ("request to stand", request(0xDEADBEEF, 0xFFFFFFFF, 0xFFFFFFF0, 1000, 0, 0.0, 0.0)),
    ("request with torque off", request(1, 2, 3, 20, 3, 0.0, 0.0)),
    ("request without a number", request(7, 2, 5050, 150, 0, float("nan"), 0.0)),
    ("motion report", motion(9, 12, 4, 2, 0, 0.475, -0.125)),
    ("motion report of a fault", motion(9, 13, 0, 4, 0x8611, 0.0, 0.0)),
    (
        "permit",
        permit(
            "obstacle in the protective field (safety scanner): 0.80 m, limit 1.20 m, 45 ms old",
            sender=7, sequence=250, acknowledged=1, stamp_us=12_345_678_901,
            permitted_mps=0.0, permitted_radps=0.0, requested_mps=0.5, requested_radps=-0.25,
            measured_mps=0.0625, measured_radps=-0.03125, speed_limit_mps=0.0,
            state=3, action=2, flags=4, cause=9, causes=(1 << 9) | (1 << 12),
            value=0.8, limit=1.2, unit=1,
            accepted=1, damaged=2, non_finite=3, late=4, out_of_order=5, repeated=6, other_sender=7,
        ),
    ),
]

if __name__ == "__main__":
    if sys.argv[1:2] == ["--decode"]:
        for name, value in decode_permit(bytes.fromhex(sys.argv[2])).items():
            print(f"{name} = {value}")
    else:
        for name, data in VECTORS:
            print(f"{name}: {data.hex()}")
