"""A device by pymodbus, which knows nothing of plcc, and an executable that has it as its inputs and outputs:
check.py tcp PORT EXECUTABLE or check.py serial LINK EXECUTABLE. The executable runs under the real clock until it is told to end."""

import asyncio
import os
import pty
import signal
import subprocess
import sys
import tty

from pymodbus.server import ModbusSerialServer, ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

UNIT = 17
# What the library makes its own tables of, which are not used.
UNUSED = SimDevice(UNIT, simdata=[SimData(0, values=0, count=8, datatype=DataType.REGISTERS)])


class Device:
    """The tables of a device, in place of those of the library."""

    def __init__(self):
        self.discrete, self.coils = [False] * 200, [False] * 200
        self.registers, self.holding = [0] * 200, [0] * 200

    def table(self, function):
        return {1: self.coils, 2: self.discrete, 3: self.holding, 4: self.registers, 15: self.coils, 16: self.holding}[function]

    def device_ids(self):
        return [UNIT]

    async def async_getValues(self, device_id, func_code, address, count=1):
        assert device_id == UNIT
        return self.table(func_code)[address:address + count]

    async def async_setValues(self, device_id, func_code, address, values):
        assert device_id == UNIT
        self.table(func_code)[address:address + len(values)] = values


async def until(what, holds):
    for _ in range(1000):
        if holds():
            return
        await asyncio.sleep(0.01)
    raise AssertionError('not in time: ' + what)


async def check(start, executable, away):
    device = Device()
    discrete, coils, registers, holding = device.discrete, device.coils, device.registers, device.holding
    # Inputs: 8 bits at I 4.0; a number of 0 to 10000 at PIW 300; two registers at ID 8, the low word first.
    discrete[0], discrete[9], registers[5], holding[20], holding[21] = True, True, 5000, 0x5678, 0x1234
    server = await start(device)
    program = subprocess.Popen([executable, '--cycle-time', '2ms', '--print', 'MW0,MW2,MW4,MD10,MW14,MB20,MB21,QW6'],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        # Outputs: bits at Q 4.0 are the inputs; QW 6 is the word of PIW 300; PQW 310 is a half of the range, as 0 to 4000.
        await until('bits', lambda: [bool(coils[at]) for at in range(100, 108)] == [True] + 7 * [False])
        await until('words', lambda: holding[30] == 13824)
        await until('range', lambda: holding[31] == 2000)
        discrete[7], discrete[0], registers[5] = True, False, 10000
        await until('changes', lambda: coils[107] and not coils[100] and holding[30] == 27648)
        if away:
            await server.shutdown()
            await asyncio.sleep(1.0)
            assert program.poll() is None, 'the program goes on'
            holding[30] = 0
            registers[5] = 2500
            server = await start(device)
            await until('again', lambda: holding[30] == 6912)
    finally:
        program.send_signal(signal.SIGTERM)
        # The server goes on meanwhile: the last outputs are written at the end.
        out, err = await asyncio.to_thread(program.communicate)
    assert program.returncode == 0, (program.returncode, out, err)
    values = dict(line.split(' = ') for line in out.splitlines())
    faults = 2 if away else 0
    assert values['MW0'] == f'16#{faults:04X}', (values, err)
    assert values['MD10'] == '16#12345678', values
    assert (values['MW2'] != '16#0000') == away, (values, err)
    assert (values['MB20'], values['MB21']) == (('16#38', '16#C4') if away else ('16#00', '16#00')), values
    # In STOP the outputs have their substitutes.
    assert (holding[30], bool(coils[107])) == (777, False), (holding[30], coils[107])
    await server.shutdown()
    print('ok')


async def tcp(port, executable):
    async def start(device):
        server = ModbusTcpServer(UNUSED, address=('127.0.0.1', int(port)))
        server.context = device
        await server.listen()
        return server

    await check(start, executable, True)


async def serial(link, executable):
    """Two pseudo-terminals, and what comes from one goes to the other."""
    masters, names = [], []
    for _ in range(2):
        master, slave = pty.openpty()
        tty.setraw(slave)
        masters.append(master)
        names.append(os.ttyname(slave))
    os.symlink(names[0], link)
    loop = asyncio.get_running_loop()
    for here, there in (masters, masters[::-1]):
        loop.add_reader(here, lambda here=here, there=there: os.write(there, os.read(here, 512)))

    async def start(device):
        server = ModbusSerialServer(UNUSED, port=names[1], baudrate=115200)
        server.context = device
        await server.listen()
        return server

    await check(start, executable, False)


asyncio.run({'tcp': tcp, 'serial': serial}[sys.argv[1]](*sys.argv[2:]))
