"""pysparkplug as a host of the plant. Arguments: port of the broker, what to do, process id of the program.

`all`: everything that a host does, with a device. `births`: prints bdSeq and a value of a node without one. `refused`: it may not write.

The program has published its births before this host came: the host asks for them again."""
import datetime
import os
import queue
import signal
import sys
import time

from pysparkplug import Client, DataType, DCmd, Message, MessageType, Metric, NCmd, QoS, Topic, get_current_timestamp

port, wanted, process = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
has_device = wanted == "all"
messages = queue.Queue()
host = Client()
host.connect("127.0.0.1", port=port, blocking=False)
for kind in ("NBIRTH", "NDEATH", "NDATA"):
    topic = Topic(message_type=MessageType[kind], group_id="plant", edge_node_id="line")
    host.subscribe(topic, QoS.AT_LEAST_ONCE, lambda _, message: messages.put(message))
for kind in ("DBIRTH", "DDATA"):
    topic = Topic(message_type=MessageType[kind], group_id="plant", edge_node_id="line", device_id="press")
    host.subscribe(topic, QoS.AT_LEAST_ONCE, lambda _, message: messages.put(message))
time.sleep(0.5)


def command(kind, metrics, retain=False):
    """Metrics as (name, type, value)."""
    now = get_current_timestamp()
    metrics = tuple(Metric(timestamp=now, name=name, datatype=ty, value=value) for name, ty, value in metrics)
    payload = {"NCMD": NCmd, "DCMD": DCmd}[kind](timestamp=now, metrics=metrics)
    device = "press" if kind == "DCMD" else None
    topic = Topic(message_type=MessageType[kind], group_id="plant", edge_node_id="line", device_id=device)
    host.publish(Message(topic=topic, payload=payload, qos=QoS.AT_LEAST_ONCE, retain=retain), include_dtypes=True)


last = None


def next_message():
    """Numbers of messages follow each other; a birth of the node has 0."""
    global last
    message = messages.get(timeout=10)
    kind = message.topic.message_type
    if kind != MessageType.NDEATH:
        seq = message.payload.seq
        if kind == MessageType.NBIRTH:
            assert seq == 0, seq
        else:
            assert last is not None and seq == (last + 1) % 256, (last, seq)
        last = seq
        assert abs(message.payload.timestamp - time.time() * 1000) < 60_000, message.payload.timestamp
    return kind, message.payload


def births():
    """The next births; what comes before them is passed over."""
    global last
    while True:
        message = messages.get(timeout=10)
        if message.topic.message_type == MessageType.NBIRTH:
            break
    last = message.payload.seq
    assert last == 0
    if not has_device:
        return message.payload, None
    kind, device = next_message()
    assert kind == MessageType.DBIRTH
    return message.payload, device


def wait(name, value):
    """Until a metric has a value."""
    until = time.time() + 10
    while time.time() < until:
        _, payload = next_message()
        for metric in payload.metrics:
            if metric.name == name:
                found = metric.value
                if found == value or isinstance(value, float) and abs(found - value) < 1e-6:
                    return
                if not isinstance(value, str) or name != "Node Info/Refused Command":
                    raise AssertionError((name, found, value))
                if value in found:
                    return
    raise AssertionError(f"{name} is not {value}")


command("NCMD", [("Node Control/Rebirth", DataType.BOOLEAN, True)])
node, device = births()
of_node = {metric.name: metric for metric in node.metrics}
if wanted == "births":
    print("bdSeq", of_node["bdSeq"].value, "value", node.metrics[-1].value)
    sys.exit()
if wanted == "refused":
    command("NCMD", [("MW10", DataType.UINT16, 5)])
    wait("Node Info/Refused Command", "the broker may not write")
    command("NCMD", [("Node Control/Rebirth", DataType.BOOLEAN, True)])
    of_node = {metric.name: metric.value for metric in births()[0].metrics}
    assert of_node["MW10"] == 0, of_node
    print("done")
    sys.exit()
assert of_node["Node Control/Rebirth"].value is False
assert of_node["Node Info/Program"].value == "plant"
assert of_node["Node Info/State"].value == "RUN"
number = of_node["bdSeq"].value
assert of_node["bdSeq"].datatype == DataType.INT64 and 0 <= number <= 255
known = {metric.name: metric for metric in device.metrics}
aliases = [metric.alias for metric in (*node.metrics, *device.metrics) if metric.alias is not None]
assert len(aliases) == len(set(aliases)) == len(node.metrics) - 1 + len(device.metrics)

UTC = datetime.timezone.utc
# Name, type, value of the birth, value to write.
VALUES = [
    ("Values.aBool", DataType.BOOLEAN, False, True),
    ("Values.aByte", DataType.UINT8, 0, 0xAB),
    ("Values.aWord", DataType.UINT16, 0, 0xABCD),
    ("Values.aDword", DataType.UINT32, 0, 0xABCDEF01),
    ("Values.aLword", DataType.UINT64, 0, 0xABCDEF0123456789),
    ("Values.aSint", DataType.INT8, 0, -128),
    ("Values.anInt", DataType.INT16, 0, -32768),
    ("Values.aDint", DataType.INT32, 0, -2147483648),
    ("Values.aLint", DataType.INT64, 0, -(2**63)),
    ("Values.aUsint", DataType.UINT8, 0, 255),
    ("Values.aUint", DataType.UINT16, 0, 65535),
    ("Values.aUdint", DataType.UINT32, 0, 2**32 - 1),
    ("Values.aUlint", DataType.UINT64, 0, 2**64 - 1),
    ("Values.aReal", DataType.FLOAT, 0.0, 2.5),
    ("Values.anLreal", DataType.DOUBLE, 0.0, -1e300),
    ("Values.aString", DataType.STRING, "", "plant"),
    ("Values.aWstring", DataType.STRING, "", "Ω 5"),
    ("Values.aTime", DataType.INT32, 0, -1500),
    ("Values.anLtime", DataType.INT64, 0, 1_500_000_000),
    ("Values.aDate", DataType.UINT16, 0, 365),
    ("Values.aTod", DataType.UINT32, 0, 86_399_999),
    ("Values.anLdt", DataType.DATETIME, datetime.datetime(2026, 1, 31, 6, tzinfo=UTC),
     datetime.datetime(2027, 2, 3, 4, 5, 6, 700_000, tzinfo=UTC)),
    ("Values.aDtl", DataType.DATETIME, datetime.datetime(2026, 1, 31, 6, 7, 8, 500_000, tzinfo=UTC),
     datetime.datetime(2030, 12, 31, 23, 59, 59, tzinfo=UTC)),
    ('Values."odd name"', DataType.INT16, 7, 8),
    ("Groups.motors[2].speed", DataType.FLOAT, 0.0, 12.5),
    ("Groups.ints[-1]", DataType.INT16, 10, 11),
    ("MW20", DataType.UINT16, 0, 77),
    ("Guarded.open", DataType.INT16, 1, 2),
    ("Guarded.mixed.a", DataType.INT16, 3, 4),
]
for name, ty, first, value in VALUES:
    metric = known[name]
    assert (metric.datatype, metric.value) == (ty, first), (name, metric)
    command("DCMD", [(name, ty, value)])
    wait(name, value)

# All of a command is written between two cycles, and only if all of it is right.
command("DCMD", [("Values.aBool", DataType.BOOLEAN, False), ("Values.anInt", DataType.INT16, 5)])
both = {metric.name: metric.value for metric in next_message()[1].metrics}
assert both == {"Values.aBool": False, "Values.anInt": 5}, both
refused = "Node Info/Refused Command"
for metrics, why in [
    ([("Values.aBool", DataType.BOOLEAN, True), ("Values.missing", DataType.INT16, 5)], "name Values.missing"),
    ([("Values.anInt", DataType.FLOAT, 5.0)], "Values.anInt: its data type is Int16"),
    ([("Values.aTod", DataType.UINT32, 86_400_000)], "Values.aTod: its type does not have this value"),
    ([("Values.aString", DataType.STRING, "too long")], "Values.aString: its type does not have this value"),
    ([("Fixed.a", DataType.UINT16, 1)], "Fixed.a: it cannot be written"),
    ([("Guarded.secret", DataType.INT16, 1)], "Guarded.secret: it cannot be written"),
    ([("Guarded.mixed.b", DataType.INT16, 1)], "Guarded.mixed.b: it cannot be written"),
    ([("Hidden.a", DataType.INT16, 1)], "Hidden.a: it cannot be written"),
    ([("Shown", DataType.INT16, 1)], "Shown: it cannot be written"),
    ([("MB45", DataType.UINT8, 1)], "MB45: it cannot be written"),
]:
    command("DCMD", metrics)
    wait(refused, why)
command("NCMD", [("MW20", DataType.UINT16, 1)])
wait(refused, "write it by DCMD")

command("NCMD", [("Node Control/Rebirth", DataType.BOOLEAN, True)])
node, device = births()
assert {metric.name: metric.value for metric in node.metrics}["bdSeq"] == number, "the connection is the same"
now = {metric.name: metric.value for metric in device.metrics}
assert (now["Values.aBool"], now["MW20"], now["Fixed.a"]) == (False, 77, 0x1234), now

os.kill(process, signal.SIGKILL)
kind, payload = next_message()
assert kind == MessageType.NDEATH and payload.bd_seq_metric.value == number, payload
host.disconnect()
print("done")
