#include "../plc.h"

enum { PLACES = 64, WEIGHT = 2 * PLACES };

static uint8_t db[WEIGHT + 4];

AREAS({"M", M, 8}, {"DB10.DB", db, sizeof db})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    memmove(db + 2, db, 2 * (PLACES - 1));
    memcpy(db, M + 4, 2);
    uint32_t sum = 0;
    for (int i = 0; i < PLACES; i++) {
        sum += rd16(db + 2 * i) & 0xFF;
    }
    wr32(db + WEIGHT, sum);
}
