"""python-snap7 against the program of this folder. Argument: the port."""
import struct
import sys
import time

import snap7

client = snap7.client.Client()
client.connect("127.0.0.1", 0, 2, int(sys.argv[1]))
assert client.get_pdu_length() == 240


def refused(action, *words):
    try:
        action()
    except Exception as error:
        assert any(word in str(error).lower() for word in words), error
    else:
        raise AssertionError(f"{words}: nothing was refused")


# All sizes, from one byte to many PDUs.
for size in [1, 2, 3, 100, 211, 212, 213, 221, 222, 223, 462, 1000, 4000]:
    data = bytes((7 * index + size) % 256 for index in range(size))
    client.db_write(1, 0, bytearray(data))
    assert bytes(client.db_read(1, 0, size)) == data, size

# Areas.
client.mb_write(10, 2, bytearray(b"\x12\x34"))
time.sleep(0.1)
assert bytes(client.mb_read(12, 2)) == b"\x12\x34"
client.eb_write(0, 1, bytearray(b"\x01"))
time.sleep(0.1)
assert bytes(client.ab_read(0, 1)) == b"\x01"
client.ct_write(3, 1, bytearray(b"\x01\x23"))
assert bytes(client.ct_read(3, 1)) == b"\x01\x23"

# A value is of one cycle.
for _ in range(50):
    block = bytes(client.db_read(4, 0, 200))
    assert block[:2] == block[198:], block

# Codes of items.
refused(lambda: client.db_read(99, 0, 2), "exist", "available")
refused(lambda: client.db_read(1, 4090, 10), "address", "range")
refused(lambda: client.db_write(3, 0, bytearray(2)), "access", "denied", "allowed")
assert bytes(client.db_read(3, 0, 2)) == b"\x12\x34"

# What the CPU says of itself.
info = client.get_cpu_info()
assert info.ASName == b"line", info
blocks = client.list_blocks()
assert (blocks.OBCount, blocks.FCCount, blocks.DBCount) == (1, 1, 4), blocks
assert client.get_block_info(snap7.type.Block.DB, 1).MC7Size == 4096
assert client.get_block_info(snap7.type.Block.FC, 7).BlkNumber == 7
assert client.get_order_code().OrderCode.startswith(b"6ES7")


def mode():
    # Answers of the library begin with length and number of records, or with the record.
    data = bytes(client.read_szl(0x0424, 0).Data)
    return data[7] if data[:2] == b"\x00\x14" else data[3]


assert mode() == 8
assert client.get_cpu_state() == "S7CpuStatusRun"
clock = client.get_plc_datetime()

# Protection: without the password the CPU is not stopped.
refused(client.plc_stop, "protection", "d241", "d2", "denied", "authorized", "0x41")
refused(lambda: client.set_session_password("wrong"), "password", "d602", "d6", "invalid", "0x02")
client.set_session_password("secret")
client.set_plc_datetime(clock)
client.plc_stop()
time.sleep(0.2)
assert mode() == 4
# This library takes every answer for RUN.
refused(client.get_cpu_state, "status")
cycles = bytes(client.db_read(2, 0, 4))
time.sleep(0.1)
assert bytes(client.db_read(2, 0, 4)) == cycles
client.plc_hot_start()
time.sleep(0.2)
assert mode() == 8
# A warm restart keeps data blocks of an S7-300.
assert struct.unpack(">i", bytes(client.db_read(2, 0, 4))) > struct.unpack(">i", cycles)
client.plc_stop()
time.sleep(0.2)
client.plc_cold_start()
time.sleep(0.2)
assert mode() == 8
assert struct.unpack(">i", bytes(client.db_read(2, 0, 4))) < struct.unpack(">i", cycles)
client.clear_session_password()
refused(client.plc_stop, "protection", "d241", "d2", "denied", "authorized", "0x41")
client.disconnect()
print("done")
