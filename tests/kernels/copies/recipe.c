#include "../plc.h"

enum { RECIPE = 40, WORK = 0, ACTIVE = 40, RESULT = 80, CHANGES = 82 };

static uint8_t db1[8 * RECIPE], db2[CHANGES + 2];

AREAS({"DB1.DB", db1, sizeof db1}, {"DB2.DB", db2, sizeof db2}, {"M", M, 10})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
    wr32(M, seed);
    wr32(M + 4, random);
    wr32(db1 + 16, random);
    wr32(db1 + 128, random);
    unsigned number = random & 7;
    wr16(M + 8, (uint16_t)number);
    memcpy(db2 + WORK, db1 + RECIPE * number, RECIPE);
    wr16(db2 + RESULT, 0);
    unsigned changes = rd16(db2 + CHANGES);
    for (int n = 0; n < 10; n++) {
        uint32_t value = rd32(db2 + WORK + 4 * n);
        if (value != rd32(db2 + ACTIVE + 4 * n)) {
            wr32(db2 + ACTIVE + 4 * n, value);
            changes++;
        }
    }
    wr16(db2 + CHANGES, (uint16_t)changes);
}
