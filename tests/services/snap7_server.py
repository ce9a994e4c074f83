"""A server of python-snap7 as partner of the program in partners/alone.scl. Argument: the port."""
import struct
import sys
import time

import snap7

data, log, merkers = bytearray(200), bytearray(4), bytearray(64)
merkers[20:22] = b"\x12\x34"
server = snap7.server.Server()
server.register_area(snap7.type.SrvArea.DB, 10, data)
server.register_area(snap7.type.SrvArea.DB, 11, log)
server.register_area(snap7.type.SrvArea.MK, 0, merkers)
server.start(int(sys.argv[1]))
for _ in range(200):
    step, status = struct.unpack(">hH", bytes(log))
    if step < 0 or step == 4:
        break
    time.sleep(0.05)
# Which error a missing data block is differs between servers: the item or the whole job.
assert step == 4 and status in (2, 8), (step, status)
assert bytes(data) == bytes(range(200)), data
print("done", flush=True)
server.stop()
