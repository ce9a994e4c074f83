"""asyncua against the programs of this folder.

Arguments: `open`, `secure` or `s7200`, the port, the folder of the server's certificate.
"""
import asyncio
import datetime
import math
import pathlib
import sys

from asyncua import Client, ua
from asyncua.crypto.cert_gen import setup_self_signed_certificate
from asyncua.crypto.security_policies import (
    SecurityPolicyAes128Sha256RsaOaep,
    SecurityPolicyAes256Sha256RsaPss,
    SecurityPolicyBasic256Sha256,
)
from cryptography.x509.oid import ExtendedKeyUsageOID

what, port, folder = sys.argv[1], int(sys.argv[2]), pathlib.Path(sys.argv[3])
URL = f"opc.tcp://127.0.0.1:{port}"
V = ua.VariantType


async def refused(status, action):
    try:
        await action
    except ua.UaStatusCodeError as error:
        assert error.code == status, f"{error}: not {status:#x}"
    else:
        raise AssertionError(f"{status:#x}: nothing was refused")


def node(client, path):
    return client.get_node(f"ns=3;s={path}")


# Value, type, and what is read again.
UTC = datetime.timezone.utc
VALUES = {
    "aBool": (True, V.Boolean),
    "aByte": (0xA5, V.Byte),
    "aWord": (0xA5C3, V.UInt16),
    "aDword": (0xA5C30F1E, V.UInt32),
    "aLword": (0xA5C30F1E12345678, V.UInt64),
    "aSint": (-128, V.SByte),
    "anInt": (-32768, V.Int16),
    "aDint": (-(2**31), V.Int32),
    "aLint": (-(2**63), V.Int64),
    "aUsint": (255, V.Byte),
    "aUint": (65535, V.UInt16),
    "aUdint": (2**32 - 1, V.UInt32),
    "aUlint": (2**64 - 1, V.UInt64),
    "aReal": (12.5, V.Float),
    "anLreal": (-1e300, V.Double),
    "aChar": (0x41, V.Byte),
    "aWchar": (0x20AC, V.UInt16),
    "aString": ("a€ü", V.String),
    "aWstring": ("Ω€", V.String),
    "aTime": (-1500, V.Int32),
    "anLtime": (-5_000_000_001, V.Int64),
    "aDate": (13179, V.UInt16),
    "aTod": (86_399_999, V.UInt32),
    "anLtod": (1, V.UInt64),
    "anLdt": (datetime.datetime(2031, 5, 6, 7, 8, 9, 123456, UTC), V.DateTime),
    "aDtl": (datetime.datetime(2031, 5, 6, 7, 8, 9, 123456, UTC), V.DateTime),
    "anS5time": (0x2127, V.UInt16),
}

ODD = [
    # Wrong types and values that the type does not have.
    ("anInt", 1, V.Int32, ua.StatusCodes.BadTypeMismatch),
    ("aReal", 1, V.Double, ua.StatusCodes.BadTypeMismatch),
    ("aBool", 1, V.Byte, ua.StatusCodes.BadTypeMismatch),
    ("aString", "123456", V.String, ua.StatusCodes.BadOutOfRange),
    ("aString", "Ω", V.String, ua.StatusCodes.BadOutOfRange),
    ("aTod", 86_400_000, V.UInt32, ua.StatusCodes.BadOutOfRange),
    ("anS5time", 0x200A, V.UInt16, ua.StatusCodes.BadOutOfRange),
    ("aDtl", datetime.datetime(1960, 1, 1), V.DateTime, ua.StatusCodes.BadOutOfRange),
    ("anInt", [1, 2], V.Int16, ua.StatusCodes.BadTypeMismatch),
]


def plain(value):
    return value.replace(tzinfo=UTC) if isinstance(value, datetime.datetime) else value


async def all_types(client):
    for name, (value, ty) in VALUES.items():
        tag = node(client, f'"Values"."{name}"')
        assert await tag.read_data_type_as_variant_type() == ty, name
        await tag.write_value(value, ty)
        read = await tag.read_data_value()
        assert (plain(read.Value.Value), read.Value.VariantType) == (value, ty), (name, read)
    # As many as a client likes, in one request.
    tags = [node(client, f'"Values"."{name}"') for name in VALUES]
    assert [plain(value) for value in await client.read_values(tags)] == [value for value, _ in VALUES.values()]
    for name, value, ty, status in ODD:
        await refused(status, node(client, f'"Values"."{name}"').write_value(value, ty))
    assert await node(client, '"Values"."odd name"').read_value() == 7
    await node(client, '"Values"."aReal"').write_value(math.nan, V.Float)
    assert math.isnan(await node(client, '"Values"."aReal"').read_value())


async def groups(client):
    moment = node(client, '"Groups"."moment"')
    assert plain(await moment.read_value()) == datetime.datetime(2024, 2, 3, 4, 5, 6, 700000, UTC)
    await moment.write_value(datetime.datetime(2089, 12, 31, 23, 59, 59, 999000), V.DateTime)
    assert plain(await moment.read_value()) == datetime.datetime(2089, 12, 31, 23, 59, 59, 999000, UTC)
    await refused(ua.StatusCodes.BadOutOfRange, moment.write_value(datetime.datetime(2090, 1, 1), V.DateTime))
    ints = node(client, '"Groups"."ints"')
    assert await ints.read_value() == [10, 20, 30, 40]
    assert await ints.read_value_rank() == 1 and await ints.read_array_dimensions() == [4]
    await ints.write_value([1, -2, 3, -4], V.Int16)
    assert await node(client, '"Groups"."ints"[-1]').read_value() == 1
    await node(client, '"Groups"."ints"[2]').write_value(5, V.Int16)
    assert await ints.read_value() == [1, -2, 3, 5]
    await refused(ua.StatusCodes.BadTypeMismatch, ints.write_value([1, 2], V.Int16))
    await refused(ua.StatusCodes.BadNodeIdUnknown, node(client, '"Groups"."ints"[3]').read_value())
    bits = [index % 3 == 0 for index in range(10)]
    await node(client, '"Groups"."bits"').write_value(bits, V.Boolean)
    assert await node(client, '"Groups"."bits"').read_value() == bits
    assert await node(client, '"Groups"."bits"[9]').read_value() is True
    table = node(client, '"Groups"."table"')
    value = ua.Variant([1, 2, 3, 4, 5, 6], V.Int32, Dimensions=[2, 3], is_array=True)
    await table.write_value(ua.DataValue(value))
    assert await node(client, '"Groups"."table"[1,2]').read_value() == 5
    read = (await table.read_data_value()).Value
    assert read.Dimensions == [2, 3] and list(read.Value) in ([1, 2, 3, 4, 5, 6], [[1, 2, 3], [4, 5, 6]]), read
    texts = node(client, '"Groups"."texts"')
    await texts.write_value(["ab", "cdef"], V.String)
    assert await texts.read_value() == ["ab", "cdef"]
    await refused(ua.StatusCodes.BadOutOfRange, texts.write_value(["x", "12345"], V.String))
    assert await texts.read_value() == ["ab", "cdef"], "all elements are written, or none"
    for path in ['"Groups"."one"', '"Groups"."motors"[2]']:
        await node(client, path + '."speed"').write_value(1.5, V.Float)
        await node(client, path + '."name"').write_value("pump", V.String)
        await node(client, path + '."hours"').write_value([1, 2, 3], V.UInt16)
        assert await node(client, path + '."hours"[3]').read_value() == 3
        members = [(await child.read_browse_name()).Name for child in await node(client, path).get_children()]
        assert members == ["speed", "running", "name", "hours"], members
    assert await node(client, '"Groups"."motors"[1]."speed"').read_value() == 0.0
    fixed = node(client, '"Fixed"."a"')
    assert await fixed.read_value() == 0x1234
    await refused(ua.StatusCodes.BadNotWritable, fixed.write_value(1, V.UInt16))
    await refused(ua.StatusCodes.BadNodeIdUnknown, node(client, '"Groups"."nothing"').read_value())
    await refused(ua.StatusCodes.BadNodeIdUnknown, node(client, '"Groups".one').read_value())
    assert "REAL" in (await node(client, '"Groups"."one"."speed"').read_description()).Text
    assert "in ms" in (await node(client, '"Values"."aTime"').read_description()).Text


async def ranged(tag, index_range, value=None):
    """Reads elements of an array, or writes them. Result: what was read, or the status."""
    if value is None:
        question = ua.ReadValueId(tag.nodeid, ua.AttributeIds.Value, IndexRange=index_range)
        found = (await tag.session.read(ua.ReadParameters(NodesToRead=[question])))[0]
        return found.Value.Value if found.StatusCode.is_good() else found.StatusCode.value
    change = ua.WriteValue(tag.nodeid, ua.AttributeIds.Value, index_range, ua.DataValue(value))
    return (await tag.session.write(ua.WriteParameters(NodesToWrite=[change])))[0].value


async def parts_of_arrays(client):
    ints, table = node(client, '"Groups"."ints"'), node(client, '"Groups"."table"')
    await ints.write_value([10, 20, 30, 40], V.Int16)
    assert await ranged(ints, "1:2") == [20, 30]
    assert await ranged(ints, "3") == [40] and await ranged(ints, "2:9") == [30, 40]
    assert await ranged(ints, "4") == ua.StatusCodes.BadIndexRangeNoData
    assert await ranged(ints, "2:1") == ua.StatusCodes.BadIndexRangeInvalid
    assert await ranged(node(client, '"Values"."anInt"'), "0") == ua.StatusCodes.BadIndexRangeInvalid
    two = ua.Variant([-1, -2], V.Int16, is_array=True)
    assert await ranged(ints, "1:2", two) == 0
    assert await ints.read_value() == [10, -1, -2, 40]
    assert await ranged(ints, "3:4", two) == ua.StatusCodes.BadIndexRangeNoData
    assert await ranged(ints, "0:2", two) == ua.StatusCodes.BadTypeMismatch
    assert await ints.read_value() == [10, -1, -2, 40]
    row = ua.Variant([7, 8], V.Int32, Dimensions=[1, 2], is_array=True)
    assert await ranged(table, "1,1:2", row) == 0
    question = ua.ReadValueId(ints.nodeid, ua.AttributeIds.Value)
    negative = ints.session.read(ua.ReadParameters(MaxAge=-1.0, NodesToRead=[question]))
    await refused(ua.StatusCodes.BadMaxAgeInvalid, negative)
    # Ranges count from 0, names as declared: the second index begins at 1.
    assert await node(client, '"Groups"."table"[1,2]').read_value() == 7
    assert await node(client, '"Groups"."table"[1,3]').read_value() == 8


async def structures(client):
    await client.load_data_type_definitions()
    one, motors = node(client, '"Groups"."one"'), node(client, '"Groups"."motors"')
    value = await one.read_value()
    assert (value.speed, value.running, value.name, value.hours) == (1.5, False, "pump", [1, 2, 3]), value
    value.speed, value.running, value.name, value.hours = -2.5, True, "fan", [7, 8, 9]
    await one.write_value(value)
    assert await node(client, '"Groups"."one"."name"').read_value() == "fan"
    assert await node(client, '"Groups"."one"."hours"').read_value() == [7, 8, 9]
    assert await node(client, '"Groups"."one"."running"').read_value() is True
    # All of it, or nothing: this name is too long.
    value.speed, value.name = 9.0, "x" * 100
    await refused(ua.StatusCodes.BadOutOfRange, one.write_value(value))
    assert await node(client, '"Groups"."one"."speed"').read_value() == -2.5
    all_motors = await motors.read_value()
    assert [len(all_motors)] == await motors.read_array_dimensions() and all_motors[-1].name == "pump", all_motors
    all_motors[0].speed = 11.5
    await motors.write_value(ua.Variant(all_motors, V.ExtensionObject, is_array=True))
    assert await node(client, '"Groups"."motors"[1]."speed"').read_value() == 11.5
    await refused(ua.StatusCodes.BadTypeMismatch, one.write_value(1.0, V.Float))
    # What has changed is told of a structure too.
    handler = Handler()
    subscription = await client.create_subscription(50, handler)
    await subscription.subscribe_data_change(one)
    await until(lambda: len(handler.seen) == 1, handler.seen)
    await node(client, '"Groups"."one"."speed"').write_value(4.5, V.Float)
    await until(lambda: handler.seen[-1][1].speed == 4.5, handler.seen)
    await subscription.delete()


async def units(client):
    unit = await (await node(client, '"Values"."aTime"').get_child("0:EngineeringUnits")).read_value()
    assert (unit.UnitId, unit.DisplayName.Text) == (0x433236, "ms"), unit
    assert len(await node(client, '"Values"."anLtime"').get_properties()) == 1
    assert await node(client, '"Values"."anInt"').get_properties() == []


async def external(client):
    """What declarations let clients do."""
    async def access(path):
        return (await node(client, path).read_attribute(ua.AttributeIds.AccessLevel)).Value.Value

    async def names(path):
        return [(await child.read_browse_name()).Name for child in await node(client, path).get_children()]

    unknown, fixed = ua.StatusCodes.BadNodeIdUnknown, ua.StatusCodes.BadNotWritable
    assert await names('"Guarded"') == ["open", "recipe", "mixed"]
    await node(client, '"Guarded"."open"').write_value(7, V.Int16)
    await refused(unknown, node(client, '"Guarded"."secret"').read_value())
    await refused(unknown, node(client, '"Guarded"."secret"').write_value(7, V.Int16))
    limit, recipe = '"Guarded"."recipe"."limit"', node(client, '"Guarded"."recipe"')
    assert await node(client, limit).read_value() == 9.5 and await access(limit) == 1
    await refused(fixed, node(client, limit).write_value(1.0, V.Float))
    await node(client, '"Guarded"."recipe"."amount"').write_value(2.5, V.Float)
    # As a whole it can be read, but not written.
    value = await recipe.read_value()
    assert (value.amount, value.limit) == (2.5, 9.5), value
    await refused(fixed, recipe.write_value(value))
    # A structure with a hidden component has no value as a whole.
    assert await node(client, '"Guarded"."mixed"').read_node_class() == ua.NodeClass.Object
    assert await names('"Guarded"."mixed"') == ["a"]
    # Addresses are no way around that, here DB 5 to 7.
    await refused(unknown, node(client, "%DB5.DBW0").read_value())
    assert await node(client, "%DB6.DBD0").read_value() == 0x3FC00000
    await refused(fixed, node(client, "%DB6.DBD0").write_value(0, V.UInt32))
    await refused(unknown, node(client, "%DB7.DBW0").read_value())
    await refused(unknown, node(client, '"Hidden"."a"').read_value())
    await refused(unknown, node(client, '"Hidden"').read_browse_name())
    # Tags, and addresses that overlap them: MW40 is hidden, MW44 can be read.
    assert not {"Secret", "%MW40"} & set(await names("Memory")) and "Shown" in await names("Memory")
    for path in ['"Secret"', "%MW40", "%MB41", "%M40.7", "%MD38", "%MD41"]:
        await refused(unknown, node(client, path).read_value())
    for path in ['"Shown"', "%MW44", "%MB45", "%MD42"]:
        assert await node(client, path).read_value() == 0 and await access(path) == 1, path
    await refused(fixed, node(client, '"Shown"').write_value(1, V.Int16))
    await refused(fixed, node(client, "%MB44").write_value(1, V.Byte))
    await node(client, "%MW42").write_value(1, V.UInt16)
    await node(client, "%MW46").write_value(1, V.UInt16)


async def browse(client):
    assert await client.get_namespace_index("http://www.siemens.com/simatic-s7-opcua") == 3
    plc = await client.nodes.objects.get_child("3:PLC")
    names = [(await child.read_browse_name()).Name for child in await plc.get_children()]
    assert names[4:] == ["Inputs", "Outputs", "Memory", "Timers", "Counters", "DataBlocks"], names
    blocks = [(await child.read_browse_name()).Name for child in await (await plc.get_child("3:DataBlocks")).get_children()]
    assert sorted(blocks) == ["Counted", "Fixed", "Groups", "Guarded", "Limits", "Values"], blocks
    found = await plc.get_child(["3:DataBlocks", "3:Groups", "3:motors", "3:[2]", "3:speed"])
    assert found.nodeid.to_string() == 'ns=3;s="Groups"."motors"[2]."speed"', found
    assert (await found.get_path())[0].nodeid == client.nodes.root.nodeid
    # More elements than one answer has.
    all_elements = await node(client, '"Counted"."all"').get_children()
    assert len(all_elements) == 200
    assert await node(client, "PLC.State").read_value() == "RUN"
    assert await node(client, "PLC.Cycle").read_value() > 0
    status = await client.get_node(ua.ObjectIds.Server_ServerStatus).read_value()
    assert status.BuildInfo.ManufacturerName == "plcc", status
    # Addresses, and the process image.
    await node(client, "%MW20").write_value(0x8000, V.UInt16)
    assert await node(client, '"Level"').read_value() == -32768
    await node(client, '"Button"').write_value(True, V.Boolean)
    await asyncio.sleep(0.1)
    assert await node(client, '"Lamp"').read_value() is True
    await refused(ua.StatusCodes.BadNodeIdUnknown, node(client, "%MW99999").read_value())


class Handler:
    def __init__(self):
        self.seen = []

    def datachange_notification(self, node, value, data):
        self.seen.append((node.nodeid.Identifier, value))


async def until(condition, what):
    for _ in range(100):
        if condition():
            return
        await asyncio.sleep(0.05)
    raise AssertionError(what)


async def subscriptions(client):
    handler = Handler()
    subscription = await client.create_subscription(50, handler)
    level, button = node(client, '"Level"'), node(client, '"Groups"."ints"')
    handles = await subscription.subscribe_data_change([level, button])
    await until(lambda: len(handler.seen) == 2, handler.seen)
    await level.write_value(77, V.Int16)
    await until(lambda: ('"Level"', 77) in handler.seen, handler.seen)
    await button.write_value([9, 9, 9, 9], V.Int16)
    await until(lambda: ('"Groups"."ints"', [9, 9, 9, 9]) in handler.seen, handler.seen)
    count = len(handler.seen)
    await asyncio.sleep(0.3)
    assert len(handler.seen) == count, "what has not changed is not told"
    await subscription.unsubscribe(handles)
    # A value that changes in each cycle is never torn.
    torn = await subscription.subscribe_data_change(node(client, '"Counted"."all"'))
    await until(lambda: len(handler.seen) > count + 5, handler.seen)
    for _, value in handler.seen[count:]:
        assert len(set(value)) == 1, value
    await subscription.unsubscribe(torn)
    # Small changes are not told, where a value has a size.
    band = await subscription.deadband_monitor(level, 10)
    await until(lambda: handler.seen[-1] == ('"Level"', 77), handler.seen)
    for value in [80, 95]:
        await level.write_value(value, V.Int16)
        await asyncio.sleep(0.2)
    assert [value for name, value in handler.seen if name == '"Level"'][-2:] == [77, 95], handler.seen
    # More values may wait than at first.
    more = ua.MonitoringParameters(ClientHandle=1000, SamplingInterval=50, QueueSize=5, DiscardOldest=True)
    request = ua.ModifyMonitoredItemsParameters(
        SubscriptionId=subscription.subscription_id,
        TimestampsToReturn=ua.TimestampsToReturn.Both,
        ItemsToModify=[ua.MonitoredItemModifyRequest(band, more)],
    )
    results = await client.uaclient.modify_monitored_items(request)
    assert [result.RevisedQueueSize for result in results] == [5], results
    await subscription.unsubscribe(band)
    for path in ['"Values"."aString"', '"Values"."aBool"', '"Groups"."one"']:
        await refused(ua.StatusCodes.BadFilterNotAllowed, subscription.deadband_monitor(node(client, path), 10))
    await subscription.delete()


class Events:
    def __init__(self):
        self.seen = []

    def event_notification(self, event):
        self.seen.append(event)


# The diagnostic buffer.
async def events(client):
    all_events, stops = Events(), Events()
    subscription = await client.create_subscription(50, all_events)
    await subscription.subscribe_events()
    chosen = await client.create_subscription(50, stops)
    await chosen.subscribe_events(evtypes=ua.ObjectIds.SystemEventType)
    state = node(client, "PLC.State")
    await state.write_value("STOP", V.String)
    await until(lambda: any("STOP" in event.Message.Text for event in all_events.seen), all_events.seen)
    await asyncio.sleep(0.1)
    await state.write_value("RUN", V.String)
    await until(lambda: any("RUN" in event.Message.Text for event in all_events.seen), all_events.seen)
    texts = [event.Message.Text.split(";")[0] for event in all_events.seen]
    assert [text for text in texts if text.startswith("16#43")] == [
        "16#4304 STOP by a client",
        "16#4301 startup",
        "16#4302 RUN",
    ], texts
    await until(lambda: len(stops.seen) == len(all_events.seen), stops.seen)
    stop = next(event for event in all_events.seen if "STOP" in event.Message.Text)
    assert (stop.SourceName, stop.Severity, stop.EventType.Identifier) == ("PLC", 100, 2130), stop
    assert len({event.EventId for event in all_events.seen}) == len(all_events.seen)
    assert (await client.nodes.server.read_event_notifier()) == {ua.EventNotifier.SubscribeToEvents}
    await refused(
        ua.StatusCodes.BadAttributeIdInvalid, subscription.subscribe_events(sourcenode=ua.ObjectIds.ObjectsFolder)
    )
    await subscription.delete()
    await chosen.delete()


async def control(client):
    cycle, all_values = node(client, '"Counted"."cycle"'), node(client, '"Counted"."all"')
    for _ in range(50):
        one, many = await client.read_values([cycle, all_values])
        assert set(many) == {one}, (one, many)
    state = node(client, "PLC.State")
    await refused(ua.StatusCodes.BadOutOfRange, state.write_value("HOLD", V.String))
    await state.write_value("STOP", V.String)
    await asyncio.sleep(0.1)
    assert await state.read_value() == "STOP"
    before = await cycle.read_value()
    await asyncio.sleep(0.1)
    assert await cycle.read_value() == before
    await state.write_value("RUN", V.String)
    await asyncio.sleep(0.1)
    assert await state.read_value() == "RUN"
    await node(client, "PLC.Clock").write_value(datetime.datetime(2030, 1, 2, 3, 4, 5), V.DateTime)
    assert (await node(client, "PLC.Clock").read_value()).year == 2030


async def without_users():
    async with Client(URL) as client:
        await browse(client)
        await all_types(client)
        await groups(client)
        await parts_of_arrays(client)
        await structures(client)
        await external(client)
        await units(client)
        await subscriptions(client)
        await events(client)
        await control(client)


POLICIES = [SecurityPolicyBasic256Sha256, SecurityPolicyAes128Sha256RsaOaep, SecurityPolicyAes256Sha256RsaPss]


async def with_users():
    key, certificate = folder / "client.pem", folder / "client.der"
    await setup_self_signed_certificate(
        key, certificate, "urn:client", "localhost", [ExtendedKeyUsageOID.CLIENT_AUTH], {"commonName": "client"}
    )
    for policy in POLICIES:
        for mode in [ua.MessageSecurityMode.Sign, ua.MessageSecurityMode.SignAndEncrypt]:
            client = Client(URL)
            client.application_uri = "urn:client"
            await client.set_security(policy, certificate, key, server_certificate=folder / "own.der", mode=mode)
            client.set_user("anna")
            client.set_password("riverside")
            async with client:
                tag = client.get_node("ns=3;s=%MW30")
                await tag.write_value(4711, V.UInt16)
                assert await tag.read_value() == 4711
                # More than one chunk in both directions, with padding of all lengths.
                block = client.get_node('ns=3;s="Bytes"."all"')
                for start in range(17):
                    value = [(start + index) % 256 for index in range(4096)]
                    await block.write_value(ua.Variant(value, V.Byte, is_array=True))
                    assert list(await block.read_value()) == value
                    assert await client.read_values([block] * (start + 1)) == [value] * (start + 1)
                # `operate` does not control the CPU.
                await refused(
                    ua.StatusCodes.BadUserAccessDenied, client.get_node("ns=3;s=PLC.State").write_value("STOP", V.String)
                )
    for name, password, status in [
        ("anna", "hillside", ua.StatusCodes.BadUserAccessDenied),
        ("nobody", "riverside", ua.StatusCodes.BadUserAccessDenied),
        (None, None, ua.StatusCodes.BadIdentityTokenRejected),
    ]:
        client = Client(URL)
        if name:
            client.set_user(name)
            client.set_password(password)
        try:
            async with client:
                raise AssertionError(f"{name} came in")
        except ua.UaStatusCodeError as error:
            assert error.code == status, (name, error)
        except ua.UaError as error:
            # Without a name this library finds no policy to sign in with.
            assert name is None, error
    # The password is encrypted on a channel without security too.
    client = Client(URL)
    client.set_user("anna")
    client.set_password("riverside")
    async with client:
        assert await client.get_node("ns=3;s=%MW30").read_value() == 4711


async def second_session():
    """A session ends long after its connection has begun; the client has time for what it does next."""
    client = Client(URL)
    await client.connect_socket()
    await client.send_hello()
    await client.open_secure_channel()
    await client.create_session()
    await client.activate_session()
    await asyncio.sleep(11)
    await client.close_session()
    await asyncio.sleep(0.5)
    await client.create_session()
    await client.activate_session()
    assert await node(client, "PLC.State").read_value() in ("RUN", "STOP")
    await client.disconnect()


async def s7200():
    async with Client(URL) as client:
        plc = await client.nodes.objects.get_child("3:PLC")

        async def names(folder):
            children = await (await plc.get_child(f"3:{folder}")).get_children()
            return sorted([(await child.read_browse_name()).Name for child in children])

        assert await names("Timers") == ["T37", "T37.VALUE"], await names("Timers")
        assert await names("Counters") == ["C5", "C5.VALUE"], await names("Counters")
        memory = ["S0.1", "SM0.5", "SMB31", "V10.3", "VW100"]
        assert await names("Memory") == memory, await names("Memory")
        assert await names("Inputs") == ["AIW2", "IB0"], await names("Inputs")
        assert await names("Outputs") == ["AQW0", "Q0.0", "Q0.1"], await names("Outputs")
        value = await plc.get_child(["3:Memory", "3:VW100"])
        await value.write_value(77, V.UInt16)
        assert await value.read_value() == 77


async def main():
    if what == "s7200":
        return await s7200()
    await (asyncio.gather(without_users(), second_session()) if what == "open" else with_users())


asyncio.run(asyncio.wait_for(main(), 60))
print("done")
