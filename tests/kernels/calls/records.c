#include "../plc.h"

enum { AMOUNT = 0, FACTOR = 2, TOTAL = 4, FLAGS = 8, TANK = 10, SUM = 80 };

static uint8_t db1[84];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 50})

static bool fill(uint8_t *tank, int flow, bool open, uint8_t *result)
{
    int amount = (int16_t)(rdint(tank + AMOUNT) + flow);
    if (open) {
        amount = (int16_t)(amount - 120);
    }
    bool empty = amount < 0, full = amount > 1000;
    if (empty) {
        amount = 0;
    }
    if (full) {
        amount = 1000;
    }
    put(tank, FLAGS, 0, full);
    put(tank, FLAGS, 1, empty);
    wr16(tank + AMOUNT, (uint16_t)amount);
    wr32(tank + TOTAL, rd32(tank + TOTAL) + (uint32_t)(amount * rdint(tank + FACTOR)));
    wr16(result, (uint16_t)amount);
    return full && !open;
}

static bool compare(const uint8_t *first, const uint8_t *second, uint8_t *greater)
{
    int a = rdint(first + AMOUNT), b = rdint(second + AMOUNT);
    wr16(greater, (uint16_t)(a > b ? a : b));
    return first[FLAGS] & second[FLAGS] & 1;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    wr16(db1 + FACTOR, M[4]);
    wr16(db1 + 5 * TANK + FACTOR, M[5]);
    wr16(M + 8, M[5]);
    wr16(M + 10, M[6]);
    for (unsigned n = 0; n < 8; n++) {
        put(M, 40, n, fill(db1 + n * TANK, rdint(M + (n % 2 ? 10 : 8)), bit(M, 4, n), M + 20 + 2 * n));
    }
    for (unsigned n = 0; n < 4; n++) {
        put(M, 41, n, compare(db1 + 2 * n * TANK, db1 + (2 * n + 1) * TANK, M + 42 + 2 * n));
    }
    wr32(db1 + SUM, rd32(db1 + TOTAL) + rd32(db1 + 5 * TANK + TOTAL));
}
