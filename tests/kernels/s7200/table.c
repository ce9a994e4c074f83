#include "../plc.h"

static uint8_t V[256] = {0x61, 0xC8, 0x86, 0x47};

AREAS({"V", V, 150})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = advance(V), random = seed ^ seed >> 15;
    wr32(V + 4, random);
    memmove(V + 102, V + 100, 40);
    memcpy(V + 100, V + 6, 2);
    unsigned sum = 0, parity = 0;
    for (int i = 0; i < 40; i++) {
        sum += V[100 + i];
        parity ^= V[100 + i];
    }
    int greatest = -32768, place = 0;
    for (int i = 1; i <= 20; i++) {
        int value = rdint(V + 98 + 2 * i);
        if (value > greatest) {
            greatest = value;
            place = i;
        }
    }
    wr16(V + 20, 21);
    wr32(V + 30, 0x0800008C);
    wr16(V + 34, (uint16_t)sum);
    V[36] = (uint8_t)parity;
    wr16(V + 40, (uint16_t)greatest);
    wr16(V + 42, (uint16_t)place);
}
