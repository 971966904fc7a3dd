"""A node of ROS 2 itself (rclpy over Fast DDS), which knows nothing of floorguard but what its topics say.

Usage: ros.py DOMAIN

The packages come from the Python registry: ros-jazzy-rclpy, ros-jazzy-rmw-fastrtps-cpp and the interfaces below. It waits for the
robot's topics, drives it by /cmd_vel until the guard stops it, and pauses and resumes it by services. Prints one line for each check, and
ends with 1 if one fails.
"""

import json
import os
import sys
import time

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]
os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")

import rclpy  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from geometry_msgs.msg import Twist, TwistStamped  # noqa: E402
from nav_msgs.msg import OccupancyGrid, Odometry  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data  # noqa: E402
from sensor_msgs.msg import Imu, LaserScan, PointCloud2  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402
from visualization_msgs.msg import MarkerArray  # noqa: E402

KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
TOPICS = {
    "/odom": (Odometry, 10),
    "/scan": (LaserScan, qos_profile_sensor_data),
    "/points": (PointCloud2, qos_profile_sensor_data),
    "/imu": (Imu, qos_profile_sensor_data),
    "/map": (OccupancyGrid, KEPT),
    "/people/costmap": (OccupancyGrid, KEPT),
    "/people/markers": (MarkerArray, 10),
    "/guard/permitted": (TwistStamped, 10),
    "/diagnostics": (DiagnosticArray, 10),
}
FAILED = []


def check(is_good, words):
    print(("good  " if is_good else "FAILED") + " " + words, flush=True)
    if not is_good:
        FAILED.append(words)


class Robot:
    """What is known of the robot, and the way to it."""

    def __init__(self):
        self.node = rclpy.create_node("somebody")
        self.newest, self.counts = {}, dict.fromkeys(TOPICS, 0)
        for name, (kind, qos) in TOPICS.items():
            self.node.create_subscription(kind, name, lambda found, name=name: self.take(name, found), qos)
        self.velocity = self.node.create_publisher(Twist, "/cmd_vel", 10)

    def take(self, name, found):
        self.counts[name] += 1
        self.newest[name] = found

    def speed(self):
        return self.newest["/odom"].twist.twist.linear.x if "/odom" in self.newest else 0.0

    def place(self):
        at = self.newest["/odom"].pose.pose.position
        return at.x, at.y

    def drive(self, ahead, seconds, until=lambda: False):
        """Twenty velocities a second; true when `until` came true."""
        ends = time.monotonic() + seconds
        while time.monotonic() < ends:
            if ahead is not None:
                velocity = Twist()
                velocity.linear.x = ahead
                self.velocity.publish(velocity)
            again = time.monotonic() + 0.05
            while time.monotonic() < again:
                rclpy.spin_once(self.node, timeout_sec=0.01)
            if until():
                return True
        return until()

    def call(self, service):
        client = self.node.create_client(Trigger, service)
        if not client.wait_for_service(timeout_sec=5.0):
            return "nobody offers it"
        answer = client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(self.node, answer, timeout_sec=5.0)
        return answer.result().success if answer.done() else "no answer"


def main():
    rclpy.init()
    robot = Robot()
    robot.drive(None, 20.0, lambda: all(robot.counts.values()))
    missing = [name for name, count in robot.counts.items() if not count]
    check(not missing, f"every topic has come; missing: {missing}")
    names = robot.node.get_node_names()
    check("floorguard" in names, f"the nodes are {sorted(names)}")
    services = {name for name, kinds in robot.node.get_service_names_and_types() if "std_srvs/srv/Trigger" in kinds}
    offered = {f"/floorguard/{name}" for name in ("pause", "resume", "reset")}
    check(offered <= services, f"the services are {sorted(services)}")
    writers = robot.node.get_publishers_info_by_topic("/scan")
    known = [f"{each.topic_type} of {each.node_name}" for each in writers]
    check(known == ["sensor_msgs/msg/LaserScan of floorguard"], f"/scan is {known}")
    if not missing:
        begin = robot.place()
        ready = robot.drive(0.4, 8.0, lambda: robot.speed() > 0.25)
        check(ready, f"the robot drives as /cmd_vel says, {robot.speed():.2f} m/s")

        def stands():
            # A velocity that comes late on a busy computer stops the robot, too; the person is 5 m ahead.
            moved = robot.place()[0] - begin[0] > 1.0
            return moved and robot.newest["/guard/permitted"].twist.linear.x == 0.0 and abs(robot.speed()) < 0.01

        stopped = robot.drive(0.4, 40.0, stands)
        went = ((robot.place()[0] - begin[0]) ** 2 + (robot.place()[1] - begin[1]) ** 2) ** 0.5
        check(stopped and went > 1.0, f"the guard stops it after {went:.2f} m")
    for service in sorted(offered):
        answer = robot.call(service)
        check(answer is True, f"{service} is answered: {answer}")
    print(json.dumps({"messages": robot.counts, "failed": FAILED}))
    return 1 if FAILED else 0


if __name__ == "__main__":
    sys.exit(main())
