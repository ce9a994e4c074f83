#include "../plc.h"
enum { READ = 0, CLS = 128, CUM = 192, MED = 256, LOW = 258, HIGH = 260, SUM = 262, SQ = 266 };
static uint8_t db[274];
AREAS({"M", M, 4}, {"DB1.DB", db, sizeof db})
void scan(uint32_t now)
{
    (void)now;
    memmove(db + READ + 2, db + READ, 126);
    uint32_t s = rd32(M) * 1664525u + 1013904223u;
    wr32(M, s);
    wr16(db + READ, (uint16_t)((s >> 16 >> 5) - 500));
    memset(db + CLS, 0, 64);
    int low = 32767, high = -32768, sum = 0;
    double sq = 0;
    for (int i = 0; i < 64; i++) {
        int v = rdint(db + READ + 2 * i), c = v / 64;
        c = c < 0 ? 0 : c > 15 ? 15 : c;
        wr32(db + CLS + 4 * c, rd32(db + CLS + 4 * c) + 1);
        low = v < low ? v : low;
        high = v > high ? v : high;
        sum += v;
        sq += (double)v * v;
    }
    wr16(db + LOW, (uint16_t)low); wr16(db + HIGH, (uint16_t)high); wr32(db + SUM, (uint32_t)sum);
    uint64_t b; memcpy(&b, &sq, 8);
    wr32(db + SQ, (uint32_t)(b >> 32)); wr32(db + SQ + 4, (uint32_t)b);
    int32_t total = 0;
    for (int i = 0; i < 16; i++) { total += rddint(db + CLS + 4 * i); wr32(db + CUM + 4 * i, (uint32_t)total); }
    int32_t half = total / 2; int i = 0;
    while (i < 15 && rddint(db + CUM + 4 * i) < half) i++;
    wr16(db + MED, (uint16_t)i);
}
