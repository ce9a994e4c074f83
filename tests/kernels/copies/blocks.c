#include "../plc.h"

enum { RECIPE = 64, WORK = 0, LOG = 64, SHADOW = 576, PATTERN = 640, RESULT = 642 };

static uint8_t db1[4 * RECIPE], db2[RESULT + 2];

AREAS({"DB1.DB", db1, sizeof db1}, {"DB2.DB", db2, sizeof db2}, {"M", M, 8})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
    wr32(M, seed);
    wr32(M + 4, random);
    wr32(db1 + 8, random);
    wr32(db1 + 72, random);
    wr32(db1 + 140, random >> 3);
    wr32(db1 + 216, random >> 3);
    memmove(db2 + LOG + 64, db2 + LOG, 7 * 64);
    memcpy(db2 + LOG, db2 + WORK, 64);
    memcpy(db2 + WORK, db1 + RECIPE * (M[4] & 3), RECIPE);
    memcpy(db2 + PATTERN, M + 6, 2);
    for (int at = SHADOW; at < SHADOW + 64; at += 2) {
        memcpy(db2 + at, db2 + PATTERN, 2);
    }
    memcpy(db2 + SHADOW + 44, db2 + WORK, 20);
    wr16(db2 + RESULT, 0);
}
