#include "../plc.h"

enum { NUMBER = 4, RING = 32, LAST = 288, PLACE = 320, CHECKS = 322 };

static uint8_t db1[CHECKS + 2];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 120})

/* Clears `size` bytes at `to`, and copies as many as both have. */
static void move(const uint8_t *from, unsigned count, uint8_t *to, unsigned size)
{
    memset(to, 0, size);
    memcpy(to, from, count < size ? count : size);
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    wr32(db1, seed);
    wr16(db1 + NUMBER, (uint16_t)(rd16(db1 + NUMBER) + 1));
    move(M, 8, db1 + 6, 8);
    move(db1 + LAST, 16, db1 + 16, 12);
    unsigned place = (rd16(db1 + PLACE) + 1) & 7;
    wr16(db1 + PLACE, (uint16_t)place);
    uint8_t *at = db1 + RING + 32 * place;
    memcpy(db1 + LAST, at, 32);
    memcpy(at, db1, 32);
    move(db1 + LAST + 2, 4, M + 100, 20);
    unsigned check = 0;
    for (unsigned n = 0; n < 16; n++) {
        check += rd16(db1 + LAST + 2 * n);
    }
    wr16(db1 + CHECKS, (uint16_t)check);
}
