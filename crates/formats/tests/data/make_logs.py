"""Writes the logs beside it: a pendulum whose angle is logged at 100 Hz and whose torque at 40 Hz, and a status at 1 Hz.

    angle'' = -9.81 sin(angle) - 0.4 angle' + 2 torque,    the torque held from message to message

Run with NumPy, pyulog, mcap and mcap-ros2-support installed; each log is read back with its own library. The files are kept because tests
run where those are not. Nothing in them was recorded: they are free to use as this repository is.
"""

import math
import struct

import numpy as np

START = 50_000_000
"""Microseconds since the start of the computer that logs."""
SECONDS = 8


def torque(k):
    """Of message k, 25 ms each."""
    return math.sin(0.11 * k) + 0.7 * math.cos(0.05 * k * (1 + 0.01 * k)) - 0.2


def simulated(seconds):
    """Angles and rates every 10 ms, by Runge-Kutta steps of 1 ms."""
    state, found = np.array([0.8, 0.0]), []
    for millisecond in range(seconds * 1000 + 1):
        if millisecond % 10 == 0:
            found.append(state.copy())
        u = torque(millisecond // 25)
        rate = lambda s: np.array([s[1], -9.81 * math.sin(s[0]) - 0.4 * s[1] + 2 * u])
        h = 1e-3
        a = rate(state)
        b = rate(state + h / 2 * a)
        c = rate(state + h / 2 * b)
        d = rate(state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
    return found


def messages(seconds):
    """Microseconds since the start, the topic, its values."""
    for k, (angle, rate) in enumerate(simulated(seconds)):
        yield 10_000 * k, "encoder", (angle, rate)
    for k in range(seconds * 40 + 1):
        yield 25_000 * k, "motor", (torque(k),)
    for k in range(seconds + 1):
        yield 1_000_000 * k + 3, "status", (k, k % 2)


def ulog(path):
    def message(kind, content):
        return struct.pack("<HB", len(content), ord(kind)) + content

    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", START)
    out += message("B", bytes(40))
    formats = [
        "encoder:uint64_t timestamp;double[2] position;",
        "motor:uint64_t timestamp;double torque;char[3] unit;uint8_t[5] _padding0;",
        "status:uint64_t timestamp;health health;bool armed;uint8_t[7] _padding0;",
        "health:uint16_t count;",
        "silent:uint64_t timestamp;float x;",
    ]
    for text in formats:
        out += message("F", text.encode())
    out += message("I", bytes([18]) + b"char[4] sys_namerig1")
    subscriptions = [(0, 0, "encoder"), (0, 1, "motor"), (0, 2, "status"), (1, 3, "status"), (0, 4, "silent")]
    for instance, number, topic in subscriptions:
        out += message("A", struct.pack("<BH", instance, number) + topic.encode())
    for micros, topic, values in sorted(messages(SECONDS)):
        stamp = struct.pack("<Q", START + micros)
        if topic == "encoder":
            out += message("D", struct.pack("<H", 0) + stamp + struct.pack("<2d", *values))
        elif topic == "motor":
            out += message("D", struct.pack("<H", 1) + stamp + struct.pack("<d", *values) + b"N m")
        else:
            for number in (2, 3):
                out += message("D", struct.pack("<H", number) + stamp + struct.pack("<H?", *values))
    with open(path, "wb") as file:
        file.write(out)


def check_ulog(path):
    import pyulog

    log = pyulog.ULog(path)
    encoder = log.get_dataset("encoder").data
    assert np.array_equal(encoder["position[0]"], [angle for angle, _ in simulated(SECONDS)])
    assert np.array_equal((encoder["timestamp"] - START) / 1e6, np.arange(SECONDS * 100 + 1) / 100)
    assert log.get_dataset("status", 1).data["health.count"][-1] == SECONDS


ulog("pendulum.ulg")
check_ulog("pendulum.ulg")


HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n"
LINE = "\n" + "=" * 80 + "\n"
JOINT_STATE = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n" + LINE + "MSG: std_msgs/Header\n" + HEADER
JOINT_STATE += LINE + "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
WRENCH = "bool on\nVector3 torque\nuint8[] picture\n" + LINE + "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
OLD_WRENCH = "bool on\nduration age\nVector3 torque\nuint8[] picture\n" + LINE + "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"


def mcap(path, compression, seconds):
    """A bag as ROS 2 writes it; the torque as ROS 1 does in one of them, the status in JSON."""
    from mcap.writer import CompressionType, Writer
    from mcap_ros2._dynamic import serialize_dynamic

    begin = 1_764_000_000 * 10**9
    with open(path, "wb") as file:
        writer = Writer(file, compression=getattr(CompressionType, compression), chunk_size=20_000)
        writer.start(profile="ros2", library="make_logs.py")
        ros1 = compression == "NONE"
        joint = writer.register_schema("sensor_msgs/msg/JointState", "ros2msg", JOINT_STATE.encode())
        if ros1:
            wrench = writer.register_schema("geometry_msgs/Wrench", "ros1msg", OLD_WRENCH.encode())
        else:
            wrench = writer.register_schema("geometry_msgs/msg/Wrench", "ros2msg", WRENCH.encode())
        status = writer.register_schema("status", "jsonschema", b'{"type": "object"}')
        other = writer.register_schema("rig.Image", "protobuf", b"")
        channels = {
            "encoder": writer.register_channel("/encoder", "cdr", joint),
            "motor": writer.register_channel("/motor/wrench", "ros1" if ros1 else "cdr", wrench),
            "status": writer.register_channel("/status", "json", status),
        }
        camera = writer.register_channel("/camera", "protobuf", other)
        as_joint = serialize_dynamic("sensor_msgs/msg/JointState", JOINT_STATE)["sensor_msgs/msg/JointState"]
        as_wrench = serialize_dynamic("geometry_msgs/msg/Wrench", WRENCH)["geometry_msgs/msg/Wrench"]
        for micros, topic, values in sorted(messages(seconds)):
            time = begin + 1000 * micros
            if topic == "encoder":
                # It was read 2 ms before it was logged.
                sec, nanosec = divmod(time - 2_000_000, 10**9)
                header = {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": "base"}
                data = as_joint({"header": header, "name": ["hinge"], "position": [values[0]], "velocity": [values[1]]})
            elif topic == "motor":
                torque = {"x": 0.0, "y": 0.0, "z": values[0]}
                picture = [7] * (100 if micros == 0 else 0)
                if ros1:
                    data = struct.pack("<?ii3dI", True, 1, 500_000_000, *torque.values(), len(picture)) + bytes(picture)
                else:
                    data = as_wrench({"on": True, "torque": torque, "picture": picture})
            else:
                data = ('{"health": {"count": %d, "text": "ok"}, "armed": %s}' % (values[0], "true" if values[1] else "false")).encode()
            writer.add_message(channels[topic], log_time=time, publish_time=time, data=data)
        writer.add_message(camera, log_time=begin, publish_time=begin, data=b"\0")
        writer.finish()


def check_mcap(path, seconds):
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        read = [m.decoded_message.position[0] for m in reader.iter_decoded_messages(topics=["/encoder"])]
    assert read == [angle for angle, _ in simulated(seconds)]


for name, compression, seconds in [("none", "NONE", 2), ("lz4", "LZ4", 2), ("zstd", "ZSTD", SECONDS)]:
    mcap(f"{name}.mcap", compression, seconds)
    check_mcap(f"{name}.mcap", seconds)
