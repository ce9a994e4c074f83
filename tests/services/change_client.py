"""asyncua while the program changes. Argument: the port. It says what it has seen, and reads a line when the program was changed."""
import asyncio
import sys

from asyncua import Client, ua

LINE = 'ns=3;s="Line".'


class stage:
    over = False


class Told:
    """What the subscription tells, by the last name of the node."""

    def __init__(self):
        self.values = {}

    def datachange_notification(self, node, value, data):
        status = data.monitored_item.Value.StatusCode
        name = node.nodeid.Identifier.split('"')[-2]
        self.values.setdefault(name, []).append(value if status is None or status.is_good() else status.name)


async def until(what, holds):
    for _ in range(200):
        if holds():
            return
        await asyncio.sleep(0.05)
    raise AssertionError(what)


async def main():
    def step(what):
        print(what, flush=True)
        return asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)

    async with Client(f"opc.tcp://127.0.0.1:{sys.argv[1]}") as client:
        await client.load_data_type_definitions()
        node = client.get_node
        told = Told()
        subscription = await client.create_subscription(100, told)
        await subscription.subscribe_data_change([node(LINE + f'"{name}"') for name in ("count", "old", "level")])
        await node(LINE + '"count"').write_value(40, ua.VariantType.Int16)
        await until("the first values", lambda: told.values.get("count", [])[-1:] == [40] and told.values.get("old") == [5])

        await step("watching")
        # The same session: `count` is at another place, `old` has gone, `extra` is new, `level` has another type.
        assert await node(LINE + '"extra"').read_value() == 7
        await node(LINE + '"count"').write_value(41, ua.VariantType.Int16)
        await until("the value at its new place", lambda: told.values["count"] == [0, 40, 41] or told.values["count"] == [40, 41])
        await until("what has gone", lambda: told.values["old"] == [5, "BadNodeIdUnknown"])
        await until("the other type", lambda: told.values["level"] == [1, 2.5])
        motor = await node(LINE + '"motor"').read_value()
        assert motor.speed == 3.5, motor
        names = [(await child.read_browse_name()).Name for child in await node('ns=3;s="Line"').get_children()]
        assert "extra" in names and "old" not in names, names
        extra = await subscription.subscribe_data_change(node(LINE + '"extra"'))
        await until("a new one", lambda: told.values.get("extra") == [7])
        await subscription.unsubscribe(extra)

        await step("went on")
        stage.over = True
        # A structure has another layout, which the client does not know: the connection ends.
        try:
            for _ in range(50):
                await node(LINE + '"motor"').read_value()
                await asyncio.sleep(0.05)
        except (ConnectionError, ua.UaError, asyncio.CancelledError):
            pass
        else:
            raise AssertionError("the client goes on with a structure of before")
    print("done", flush=True)


try:
    asyncio.run(main())
except (ConnectionError, ua.UaError):
    # The end of the session has nobody to say it to.
    if not stage.over:
        raise
    print("done", flush=True)
