#include "../plc.h"

static uint8_t V[256] = {0x61, 0xC8, 0x86, 0x47};

AREAS({"V", V, 232})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = advance(V);
    wr32(V + 4, (seed ^ seed >> 15) & 0xFFFF7FFF);
    unsigned place = (rd16(V + 10) + 1) & 15;
    wr16(V + 10, (uint16_t)place);
    memcpy(V + 100 + 2 * place, V + 6, 2);
    memcpy(V + 200, V + 100, 32);
    int swaps = 0;
    for (int pass = 1; pass <= 15; pass++) {
        uint8_t *at = V + 200;
        for (int i = 1; i <= 16 - pass; i++, at += 2) {
            int left = rdint(at), right = rdint(at + 2);
            if (left > right) {
                wr16(at, (uint16_t)right);
                wr16(at + 2, (uint16_t)left);
                swaps++;
            }
        }
    }
    wr16(V + 12, (uint16_t)swaps);
    int32_t sum = 0, weighted = 0;
    for (int i = 1; i <= 16; i++) {
        int value = rdint(V + 98 + 2 * i);
        sum += value;
        weighted += value * i;
    }
    /* What the loops leave: indices and the last limit. */
    wr16(V + 20, 17);
    wr16(V + 22, 2);
    wr16(V + 24, 1);
    wr32(V + 30, (uint32_t)sum);
    wr32(V + 34, (uint32_t)weighted);
    wr32(V + 38, (uint32_t)(sum / 16));
}
