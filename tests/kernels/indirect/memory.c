#include "../plc.h"

enum { RING = 0, HISTOGRAM = 128, PLACE = 160, TOTAL = 162 };

static uint8_t db1[TOTAL + 4];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 28})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M);
    unsigned place = rd16(db1 + PLACE), random = 0;
    for (int n = 0; n < 16; n++) {
        seed += 0x9E3779B9u;
        random = (seed ^ seed >> 15) & 0xFFF;
        place = (place + 1) & 0x3F;
        wr16(db1 + RING + 2 * place, (uint16_t)random);
        uint8_t *class = db1 + HISTOGRAM + 2 * (random >> 8);
        wr16(class, (uint16_t)(rd16(class) + 1));
        unsigned number = random & 0x3F;
        M[20 + number / 8] ^= (uint8_t)(1 << number % 8);
    }
    wr32(M, seed);
    wr16(M + 8, (uint16_t)random);
    wr16(db1 + PLACE, (uint16_t)place);
    int32_t total = 0;
    for (int k = 0; k < 64; k++) {
        total += rdint(db1 + RING + 2 * k);
    }
    wr32(db1 + TOTAL, (uint32_t)total);
    unsigned bits = 0;
    for (unsigned k = 0; k < 64; k++) {
        bits += bit(M, 20 + k / 8, k % 8);
    }
    wr16(M + 12, (uint16_t)bits);
}
