"""pymodbus against the program of this folder. Argument: the port."""
import sys
import time

from pymodbus.client import ModbusTcpClient

client = ModbusTcpClient("127.0.0.1", port=int(sys.argv[1]))
assert client.connect()


def value(answer):
    assert not answer.isError(), answer
    return answer


def exception(answer, code):
    assert answer.isError() and answer.exception_code == code, answer


# Holding registers are DB 1, input registers DB 2.
value(client.write_register(0, 0xABCD))
value(client.write_registers(10, list(range(100, 223))))
assert value(client.read_holding_registers(0, count=1)).registers == [0xABCD]
assert value(client.read_holding_registers(10, count=123)).registers == list(range(100, 223))
assert value(client.read_input_registers(2, count=2)).registers == [0x3FC0, 0]
first = value(client.read_input_registers(0, count=2)).registers
time.sleep(0.1)
assert value(client.read_input_registers(0, count=2)).registers > first
value(client.mask_write_register(address=10, and_mask=0xFF00, or_mask=0x0055))
assert value(client.read_holding_registers(10, count=1)).registers == [0x0055]
both = client.readwrite_registers(read_address=20, read_count=2, address=20, values=[7])
assert value(both).registers == [7, 111]

# Coils are Q, discrete inputs I. Q 0.0 is written by the program.
value(client.write_coil(9, True))
value(client.write_coils(13, [True, False, True]))
assert value(client.read_coils(8, count=8)).bits == [False, True, False, False, False, True, False, True]
assert value(client.read_discrete_inputs(3, count=5)).bits[:5] == [False] * 5

device = value(client.read_device_information(read_code=2)).information
assert device[1].startswith(b"6ES7 315-2") and device[6] == b"line", device
exception(client.read_holding_registers(2048, count=1), 2)
exception(client.read_holding_registers(2000, count=100), 2)
exception(client.write_register(65535, 1), 2)
client.close()
print("done")
