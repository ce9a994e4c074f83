"""A server of python-snap7 as partner of the program in partners/one.scl. Argument: the port."""
import struct
import sys
import time

import snap7

data, log, merkers = bytearray(20), bytearray(8), bytearray(64)
server = snap7.server.Server()
server.register_area(snap7.type.SrvArea.DB, 10, data)
server.register_area(snap7.type.SrvArea.DB, 11, log)
server.register_area(snap7.type.SrvArea.MK, 0, merkers)
server.start(int(sys.argv[1]))
for _ in range(200):
    step = struct.unpack(">h", bytes(log[:2]))[0]
    # From step 4 on PUT, GET and a data block that is missing have done what they should.
    if step < 0 or step >= 4:
        break
    time.sleep(0.05)
assert step >= 4, struct.unpack(">hHhh", bytes(log))
assert bytes(data) == bytes((7 * index + 1) % 256 for index in range(20)), data
assert merkers[20] == 8, merkers
print("done", flush=True)
server.stop()
