#include "../plc.h"

enum { VALUE = 0, SORTED = 64, PLACE = 128, SWAPS = 130, FOUND = 132, LIMIT = 134 };

static uint8_t db1[LIMIT + 4];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 8})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    unsigned place = (rd16(db1 + PLACE) + 1) & 15;
    wr16(db1 + PLACE, (uint16_t)place);
    wrreal(db1 + VALUE + 4 * place, (float)rdint(M + 6) * 1e-2f);
    memcpy(db1 + SORTED, db1 + VALUE, 64);
    int swaps = 0;
    for (int outer = 15; outer > 0; outer--) {
        uint8_t *at = db1 + SORTED;
        for (int inner = outer; inner > 0; inner--, at += 4) {
            float left = rdreal(at), right = rdreal(at + 4);
            if (!(left <= right)) {
                wrreal(at, right);
                wrreal(at + 4, left);
                swaps++;
            }
        }
    }
    wr16(db1 + SWAPS, (uint16_t)swaps);
    wrreal(db1 + LIMIT, 50.0f);
    int n = 0;
    while (n < 16 && !(rdreal(db1 + SORTED + 4 * n) > 50.0f)) {
        n++;
    }
    wr16(db1 + FOUND, (uint16_t)n);
}
