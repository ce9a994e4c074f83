#include "../iec.h"
#include "../plc.h"

AREAS({"M", M, 40}, {"Q", Q, 2})

static struct belt {
    struct timer start, runs_on, flash;
    int16_t parts;
    bool up;
} belts[8];

void scan(uint32_t now)
{
    uint32_t bits = rd32(M) + 1640531527u;
    wr32(M, bits);
    bits ^= bits >> 15;
    bits ^= bits << 7;
    wr32(M + 4, bits);
    I[0] = M[0] | M[1];
    I[1] = M[5];
    for (unsigned k = 0; k < 8; k++) {
        struct belt *belt = &belts[k];
        bool ready = on_delay(&belt->start, bit(I, 0, k), 3 + k, now);
        put(M, 20, k, ready);
        bool runs = off_delay(&belt->runs_on, ready & bit(I, 1, k), 12 + k, now);
        put(Q, 0, k, runs);
        bool lamp = pulse(&belt->flash, bit(I, 1, k) & !runs, 9 + 2 * k, now);
        put(Q, 1, k, lamp);
        if (bit(M, 21, k)) {
            belt->parts = 0;
        } else if (lamp && !belt->up && belt->parts < INT16_MAX) {
            belt->parts++;
        }
        belt->up = lamp;
        put(M, 21, k, belt->parts >= 5 + (int)k);
        wr16(M + 24 + 2 * k, (uint16_t)belt->parts);
    }
    wr32(M + 8, belts[0].start.elapsed + belts[3].start.elapsed + belts[7].start.elapsed);
}
