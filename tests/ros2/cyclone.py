"""A program of ROS 2 over Cyclone DDS, which knows nothing of floorguard but what its topics say.

Usage: cyclone.py DOMAIN [--read SECONDS | --stall SECONDS]

It waits for the robot's topics, drives it by /cmd_vel until the robot is stopped by something ahead, and pauses and resumes it by
services. Prints one line for each check, and ends with 1 if one fails. With --read it only reads everything for so long, and with --stall
it subscribes to everything and reads nothing.
"""

import json
import os
import sys
import time

os.environ["CYCLONEDDS_URI"] = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>20</MaxAutoParticipantIndex>"
    "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>"
)

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402

import messages as ros  # noqa: E402

XCDR1 = Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False)
# The profiles of ROS 2: the default, that of sensors, and that of what is kept for those who come late.
DEFAULT = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10), XCDR1)
SENSOR = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5), XCDR1)
KEPT = Qos(
    Policy.Reliability.Reliable(duration(seconds=1)),
    Policy.Durability.TransientLocal,
    Policy.History.KeepLast(100),
    XCDR1,
)
TOPICS = {
    "/tf": (ros.TFMessage, DEFAULT),
    "/tf_static": (ros.TFMessage, KEPT),
    "/odom": (ros.Odometry, DEFAULT),
    "/scan": (ros.LaserScan, SENSOR),
    "/points": (ros.PointCloud2, SENSOR),
    "/imu": (ros.Imu, SENSOR),
    "/people": (ros.Detection3DArray, DEFAULT),
    "/people/costmap": (ros.OccupancyGrid, KEPT),
    "/map": (ros.OccupancyGrid, KEPT),
    "/diagnostics": (ros.DiagnosticArray, DEFAULT),
    "/guard/permitted": (ros.TwistStamped, DEFAULT),
    "/collision_monitor_state": (ros.CollisionMonitorState, DEFAULT),
    "/speed_limit": (ros.SpeedLimit, DEFAULT),
}
STOP = 1
LATE = "wanted command"
FAILED = []


def check(is_good, words):
    print(("good  " if is_good else "FAILED") + " " + words, flush=True)
    if not is_good:
        FAILED.append(words)


class Robot:
    """What is known of the robot, and the way to it."""

    def __init__(self, domain):
        self.participant = DomainParticipant(domain)
        self.readers = {
            name: DataReader(self.participant, Topic(self.participant, "rt" + name, kind, qos=qos), qos=qos)
            for name, (kind, qos) in TOPICS.items()
        }
        discovery = Topic(self.participant, "ros_discovery_info", ros.ParticipantEntitiesInfo, qos=KEPT)
        self.readers["ros_discovery_info"] = DataReader(self.participant, discovery, qos=KEPT)
        velocity = Topic(self.participant, "rt/cmd_vel", ros.Twist, qos=DEFAULT)
        self.velocity = DataWriter(self.participant, velocity, qos=DEFAULT)
        self.newest, self.counts, self.frames, self.lines = {}, dict.fromkeys(self.readers, 0), set(), {}
        self.began = time.monotonic()

    def listen(self):
        for name, reader in self.readers.items():
            for sample in reader.take(N=64):
                if not isinstance(sample, (TOPICS.get(name) or (ros.ParticipantEntitiesInfo,))[0]):
                    continue  # the writer has gone
                self.counts[name] += 1
                self.newest[name] = sample
                if name in ("/tf", "/tf_static"):
                    self.frames |= {(each.header.frame_id, each.child_frame_id) for each in sample.transforms}

    def speed(self):
        odometry = self.newest.get("/odom")
        return odometry.twist.twist.linear.x if odometry else 0.0

    def place(self):
        at = self.newest["/odom"].pose.pose.position
        return at.x, at.y

    def restraint(self):
        state = self.newest.get("/collision_monitor_state")
        return (state.action_type, state.polygon_name) if state else (None, "")

    def drive(self, ahead, seconds, until=lambda: False):
        """Twenty velocities a second; true when `until` came true."""
        ends = time.monotonic() + seconds
        while time.monotonic() < ends:
            if ahead is not None:
                self.velocity.write(ros.Twist(ros.Vector3(ahead), ros.Vector3()))
            for _ in range(5):
                time.sleep(0.01)
                self.listen()
            if until():
                return True
        return until()

    def call(self, service, number):
        """A service of std_srvs/Trigger as rmw_cyclonedds calls it."""
        ask = Topic(self.participant, f"rq{service}Request", ros.TriggerRequest, qos=DEFAULT)
        answer = Topic(self.participant, f"rr{service}Reply", ros.TriggerResponse, qos=DEFAULT)
        answers = DataReader(self.participant, answer, qos=DEFAULT)
        requests = DataWriter(self.participant, ask, qos=DEFAULT)
        for _ in range(50):
            if requests.get_matched_subscriptions() and answers.get_matched_publications():
                break
            self.drive(None, 0.05)
        requests.write(ros.TriggerRequest(4711, number))
        found = []
        self.drive(None, 3.0, lambda: bool(found.extend(answers.take(N=8)) or found))
        return [(each.client, each.sequence, each.success) for each in found]


def check_topics(robot):
    wanted = set(TOPICS) | {"ros_discovery_info"}
    robot.drive(None, 20.0, lambda: all(robot.counts[name] for name in wanted))
    missing = sorted(name for name in wanted if not robot.counts[name])
    check(not missing, f"every topic has come; missing: {missing}")
    if missing:
        return
    links = {("odom", "base_link"), ("base_link", "lidar"), ("base_link", "scanner")}
    check(links <= robot.frames, f"the tree of frames holds {sorted(robot.frames)}")
    scan, cloud = robot.newest["/scan"], robot.newest["/points"]
    beams = round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1
    check(len(scan.ranges) == beams > 100, f"a scan has {len(scan.ranges)} beams")
    check(len(cloud.data) == cloud.width * cloud.point_step > 10_000, f"a cloud has {cloud.width} points")
    stamp = robot.newest["/odom"].header.stamp
    age = time.time() - stamp.sec - stamp.nanosec * 1e-9
    check(-0.2 < age < 2.0, f"stamps are of the clock on the wall, {age:.3f} s ago")
    stamp = robot.newest["/tf"].transforms[0].header.stamp
    age = time.time() - stamp.sec - stamp.nanosec * 1e-9
    check(-0.2 < age < 2.0, f"those of frames, too, {age:.3f} s ago")
    nodes = [node.node_name for node in robot.newest["ros_discovery_info"].node_entities_info_seq]
    check(nodes == ["floorguard"], f"its node is {nodes}")
    costs = robot.newest["/people/costmap"]
    check(len(costs.data) == costs.info.width * costs.info.height, f"a costmap has {len(costs.data)} cells")


def check_people(robot):
    def is_there():
        people = robot.newest["/people"].detections
        return any(one.results[0].hypothesis.class_id == "person" for one in people)

    check(robot.drive(None, 10.0, is_there), "a person is seen")
    check(robot.drive(None, 2.0, lambda: max(robot.newest["/people/costmap"].data) == 100), "and costs in the costmap")


def check_drive(robot):
    begin = robot.place()
    ready = robot.drive(0.4, 8.0, lambda: robot.speed() > 0.25)
    check(ready, f"the robot drives as /cmd_vel says, {robot.speed():.2f} m/s, restraint {robot.restraint()}")

    def is_stopped():
        # A velocity that comes late on a busy computer stops the robot, too, until the next one; that is not meant here.
        action, cause = robot.restraint()
        return action == STOP and cause != LATE and abs(robot.speed()) < 0.01

    stopped = robot.drive(0.4, 40.0, is_stopped)
    went = ((robot.place()[0] - begin[0]) ** 2 + (robot.place()[1] - begin[1]) ** 2) ** 0.5
    check(stopped and went > 1.0, f"the guard stops it after {went:.2f} m because of {robot.restraint()[1]!r}")
    permitted = robot.newest["/guard/permitted"].twist.linear.x
    check(permitted == 0.0, f"it permits {permitted} m/s")
    limit = robot.newest["/speed_limit"]
    check(not limit.percentage and 0.0 < limit.speed_limit < 0.3, f"nav2 is told {limit.speed_limit:.3f} m/s")


def check_services(robot):
    for number, service in enumerate(("pause", "resume", "reset"), 1):
        answers = robot.call(f"/floorguard/{service}", number)
        check(answers == [(4711, number, True)], f"{service} is answered: {answers}")


def main():
    robot = Robot(int(sys.argv[1]))
    if len(sys.argv) > 3:
        if sys.argv[2] == "--read":
            robot.drive(None, float(sys.argv[3]))
        else:
            time.sleep(float(sys.argv[3]))
        print(json.dumps({"messages": robot.counts}))
        return 0 if sys.argv[2] == "--stall" or any(robot.counts.values()) else 1
    check_topics(robot)
    if not FAILED:
        check_people(robot)
        check_drive(robot)
        check_services(robot)
    print(json.dumps({"messages": robot.counts, "failed": FAILED}))
    return 1 if FAILED else 0


if __name__ == "__main__":
    sys.exit(main())
