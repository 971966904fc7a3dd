"""Reads a recording of floorguard with readers that others wrote, and says what they found.

Usage: check.py RECORDING.mcap [--cuts N]

Each reader is asked for everything: every message decoded, the frame tree connected, clouds, scans and maps of the size
that they claim, the index in agreement with the content, and a cut file read up to its cut. Prints one line for each
check, and one JSON object at the end; ends with 1 if a reader disagrees.
"""

import collections
import io
import json
import math
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile

from mcap.exceptions import EndOfFile, McapError
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader

# A cut may cost another reader the chunk that was cut: a quarter of a second, or longer where nothing happened for longer,
# and what a message may be late by.
CHUNK_S = 0.25
LATE_S = 0.1
# What a whole simulated robot says; a real one may lack devices, and what `replay` found has only what it found.
EXPECTED = {
    "/lidar/points": "sensor_msgs/msg/PointCloud2",
    "/scanner/scan": "sensor_msgs/msg/LaserScan",
    "/imu": "sensor_msgs/msg/Imu",
    "/odometry": "nav_msgs/msg/Odometry",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/people": "visualization_msgs/msg/MarkerArray",
    "/people/detections": "vision_msgs/msg/Detection3DArray",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/raw/lidar": "std_msgs/msg/UInt8MultiArray",
}

results = []


def check(name, holds, found):
    results.append({"check": name, "holds": bool(holds), "found": str(found)})
    print(f"  {'good' if holds else 'BAD '} {name}: {found}")


def with_mcap(path):
    """The reference reader, with every checksum."""
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary, header = reader.get_summary(), reader.get_header()
        about = {key: value for data in reader.iter_metadata() for key, value in data.metadata.items()}
        counts, schemas = collections.Counter(), {}
        last_ns, sorted_by_time = 0, True
        for schema, channel, message in reader.iter_messages():
            counts[channel.topic] += 1
            schemas[channel.topic] = schema.name
            sorted_by_time &= message.log_time >= last_ns
            last_ns = message.log_time
    total = sum(counts.values())
    check("mcap: profile", header.profile == "ros2", header.profile)
    check("mcap: index agrees", summary.statistics.message_count == total, f"{total} messages")
    check("mcap: chunks to seek by", len(summary.chunk_indexes) > 1, f"{len(summary.chunk_indexes)} chunks")
    check("mcap: in the order of time", sorted_by_time, sorted_by_time)
    expected = EXPECTED if "seed" in about else {topic: kind for topic, kind in EXPECTED.items() if topic in schemas}
    missing = [topic for topic, kind in expected.items() if schemas.get(topic) != kind]
    check("mcap: topics and types", not missing, missing or f"{len(schemas)} topics")
    return counts


def with_mcap_ros2(path, counts):
    """Every message decoded by the definition that stands in the file."""
    from mcap_ros2.decoder import DecoderFactory

    decoded = 0
    with open(path, "rb") as file:
        for *_, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            decoded += message is not None
    check("mcap-ros2-support: decoded", decoded == sum(counts.values()), f"{decoded} messages")


def with_rosbags(path, counts):
    """Every message decoded; what is in them is of the size that they claim."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    seen, parents, grids, bad = collections.Counter(), {}, {}, []
    with AnyReader([pathlib.Path(path)], default_typestore=store) as reader:
        for connection, _, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            seen[connection.topic] += 1
            kind = connection.msgtype.rsplit("/", 1)[-1]
            if kind == "PointCloud2" and len(message.data) != message.width * message.height * message.point_step:
                bad.append(connection.topic)
            if kind == "LaserScan":
                beams = round((message.angle_max - message.angle_min) / message.angle_increment) + 1
                if beams != len(message.ranges):
                    bad.append(connection.topic)
            if kind == "OccupancyGrid":
                grids[connection.topic] = grids.get(connection.topic, 0) + 1
                if len(message.data) != message.info.width * message.info.height or message.info.resolution <= 0:
                    bad.append(connection.topic)
            if kind == "Odometry" and not math.isfinite(message.pose.pose.position.x):
                bad.append(connection.topic)
            for each in getattr(message, "transforms", []):
                parents[each.child_frame_id] = each.header.frame_id
    check("rosbags: decoded", seen == counts, f"{sum(seen.values())} messages")
    check("rosbags: sizes of clouds, scans and maps", not bad, sorted(set(bad)) or "as claimed")
    check("rosbags: maps", all(count > 1 for count in grids.values()), grids or "no map in this recording")

    def root(frame):
        for _ in range(8):
            frame = parents.get(frame, frame)
        return frame

    roots = {root(frame) for frame in parents}
    check("rosbags: one frame tree", len(roots) == 1 and len(parents) > 1, f"{sorted(parents)} under {sorted(roots)}")


def count_until_cut(data):
    """Messages of a file that may be cut, and the time of the last."""
    messages, last_ns = 0, 0
    try:
        for record in StreamReader(io.BytesIO(data)).records:
            if isinstance(record, Message):
                messages, last_ns = messages + 1, max(last_ns, record.log_time)
    except (EndOfFile, McapError, ValueError, struct.error):
        pass
    return messages, last_ns


def ends_of_chunks(data):
    """Where chunks end in the file, and the time of the last message in each: from the format itself."""
    ends, offset = [], 8
    while offset + 9 <= len(data):
        length = int.from_bytes(data[offset + 1 : offset + 9], "little")
        if data[offset] == 6:
            ends.append((offset + 9 + length, int.from_bytes(data[offset + 17 : offset + 25], "little")))
        offset += 9 + length
    return ends


def with_cuts(path, cuts):
    """A cut file gives this reader every whole chunk."""
    data = pathlib.Path(path).read_bytes()
    ends = ends_of_chunks(data)
    random.seed(1)
    worst_s, wrong = 0.0, 0
    for _ in range(cuts):
        cut = random.randrange(8, ends[-1][0])
        whole = [last_ns for end, last_ns in ends if end <= cut]
        _, last_ns = count_until_cut(data[:cut])
        wrong += last_ns < max(whole, default=0)
        nearest = min((last_ns for end, last_ns in ends if end > cut), default=last_ns)
        worst_s = max(worst_s, (nearest - last_ns) * 1e-9)
    gaps_s = [(later - sooner) * 1e-9 for (_, sooner), (_, later) in zip(ends, ends[1:])]
    at_most_s = max([CHUNK_S, *gaps_s]) + LATE_S
    check("mcap: cut files", wrong == 0 and worst_s <= at_most_s, f"{cuts} cuts, {worst_s:.2f} s lost at most")


def with_rerun(path, counts):
    """Rerun's own importer, where its wheel is installed."""
    program = shutil.which("rerun", path=str(pathlib.Path(sys.executable).parent))
    if program is None:
        print("  skipped: rerun is not installed")
        return
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "run.rrd"
        quiet = {"capture_output": True, "text": True, "timeout": 600, "check": True}
        subprocess.run([program, "mcap", "convert", str(path), "-o", str(out)], **quiet)
        told = subprocess.run([program, "rrd", "print", "-v", str(out)], **quiet).stdout
    rows = collections.Counter()
    for count, entity, columns in re.findall(r"with ([\d ]+) rows .*? - (/\S+) - data columns: \[(.*?)\]", told):
        for archetype in set(re.findall(r"@(\w+):", columns)):
            rows[entity, archetype] += int(count.replace("\u2009", "").replace(" ", ""))
    for entity, archetype in [("/lidar/points", "Points3D"), ("/tf", "Transform3D"), ("/floorguard/digest", "TextDocument")]:
        if counts[entity] == 0:
            print(f"  skipped: rerun: no {entity} in this recording")
            continue
        check(f"rerun: {entity} as {archetype}", rows[entity, archetype] > 0, f"{rows[entity, archetype]} rows")


def main():
    path = sys.argv[1]
    cuts = int(sys.argv[3]) if len(sys.argv) > 3 and sys.argv[2] == "--cuts" else 40
    counts = with_mcap(path)
    with_mcap_ros2(path, counts)
    with_rosbags(path, counts)
    with_cuts(path, cuts)
    with_rerun(path, counts)
    bad = [result for result in results if not result["holds"]]
    print(json.dumps({"passed": not bad, "checks": len(results), "bad": bad}))
    sys.exit(1 if bad else 0)


main()
