#include "../plc.h"

enum { SUM = 40, PARITY = 42, ZEROS = 44, PLACE = 46, KEY = 48 };

static uint8_t db1[KEY + 2];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 8})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
    wr32(M, seed);
    wr32(M + 4, random);
    wr32(db1 + (M[4] & 31), random);
    memcpy(db1 + KEY, db1 + 6, 2);
    unsigned sum = 0, parity = 0, zeros = 0;
    for (int n = 0; n < 40; n++) {
        sum += db1[n];
        parity ^= db1[n];
        zeros += db1[n] == 0;
    }
    wr16(db1 + SUM, (uint16_t)sum);
    wr16(db1 + PARITY, (uint16_t)parity);
    wr16(db1 + ZEROS, (uint16_t)zeros);
    int place = 0;
    while (place < 39 && rd16(db1 + place) != rd16(db1 + KEY)) {
        place++;
    }
    wr16(db1 + PLACE, (uint16_t)place);
}
