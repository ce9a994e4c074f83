#include "../plc.h"

enum { BYTES = 0, RESULTS = 128 };

static uint8_t db1[RESULTS + 20];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 8})

static uint16_t check(const uint8_t *data, unsigned length)
{
    uint16_t check = 0;
    for (unsigned n = 0; n < length; n++) {
        check = (uint16_t)((check + data[n]) ^ data[n] << 8);
    }
    return check;
}

static void result(unsigned number, const uint8_t *data, unsigned length)
{
    wr16(db1 + RESULTS + 2 * number, check(data, length));
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
    wr32(M, seed);
    wr32(M + 4, random);
    wr32(db1 + 16, random);
    wr32(db1 + 62, random);
    wr32(db1 + 101, random);
    result(0, db1, 20);
    result(1, db1 + 10, 30);
    result(2, M, 8);
    result(3, db1 + 60, 16);
    result(4, db1 + 100, 12);
    result(5, db1, 64);
    result(6, db1 + 64, 64);
    result(7, M + 4, 4);
    result(8, db1 + 30, 40);
    result(9, db1 + 128, 16);
}
