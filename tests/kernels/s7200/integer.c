#include "../plc.h"

static uint8_t V[128] = {0x61, 0xC8, 0x86, 0x47};
static bool edges[16], runs;

AREAS({"V", V, 88})

static int limit(int low, int value, int high)
{
    value = value > high ? high : value;
    return value < low ? low : value;
}

static unsigned bcd(unsigned value)
{
    return value % 10 | value / 10 % 10 << 4 | value / 100 % 10 << 8 | value / 1000 << 12;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = advance(V);
    uint32_t random = seed ^ seed >> 15;
    wr32(V + 4, random & 0x3FFF3FFF);
    wr32(V + 8, (random << 5 ^ random) & 0x3FFF3FFF);
    for (int i = 0; i < 16; i++) {
        int value = rdint(V + 4 + 2 * (i % 4)) * (700 + 50 * i) / 1000;
        wr16(V + 20 + 2 * i, (uint16_t)limit(10 * i, value, 9000 + 100 * i));
    }
    int sum = 0, largest = rdint(V + 64), events = rdint(V + 66);
    unsigned check = rd16(V + 62);
    for (int i = 0; i < 16; i++) {
        int value = rdint(V + 20 + 2 * i);
        sum += value;
        check ^= (unsigned)value;
        largest = value > largest ? value : largest;
        bool high = value > 3000 + 200 * i;
        put(V, 70 + i / 8, i % 8, high);
        events += runs & high & !edges[i];
        edges[i] = high;
    }
    runs = true;
    wr32(V + 84, (uint32_t)sum);
    wr16(V + 62, (uint16_t)check);
    wr16(V + 64, (uint16_t)largest);
    wr16(V + 66, (uint16_t)events);
    wr16(V + 68, (uint16_t)bcd((unsigned)events & 0xFFF));
}
