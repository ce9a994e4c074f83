#include "../iec.h"
#include "../plc.h"

enum { LIT = 0, LONGEST = 2, SWITCHED = 6 };

static uint8_t result[SWITCHED + 32];

AREAS({"DB2.DB", result, sizeof result}, {"M", M, 10})

static struct lamp {
    struct timer on, off;
    bool lit;
    int16_t switched;
} lamps[16];

void scan(uint32_t now)
{
    uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
    wr32(M, seed);
    wr32(M + 4, random);
    uint16_t sensors = (uint16_t)(random >> 16 | random);
    wr16(M + 8, sensors);
    int lit = 0;
    uint32_t longest = 0;
    for (unsigned i = 0; i < 16; i++) {
        struct lamp *lamp = &lamps[i];
        uint32_t delay = 2 + i % 4;
        bool ready = on_delay(&lamp->on, sensors >> i & 1, delay, now);
        bool on = off_delay(&lamp->off, ready, delay + 3, now);
        lamp->switched += on & !lamp->lit;
        lamp->lit = on;
        lit += on;
        longest = lamp->off.elapsed > longest ? lamp->off.elapsed : longest;
        wr16(result + SWITCHED + 2 * i, (uint16_t)lamp->switched);
    }
    wr16(result + LIT, (uint16_t)lit);
    wr32(result + LONGEST, longest);
}
