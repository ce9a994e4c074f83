#include "../plc.h"

enum { POINTER = 10, FULL = 20, SUM = 22, N = 24, MEAN = 26, OLDEST = 28, STARTS = 30, STOPS = 32, LEVELS = 200, TABLE = 300 };

static uint8_t V[TABLE + 24] = {0x61, 0xC8, 0x86, 0x47};

AREAS({"V", V, sizeof V})

static struct timer {
    uint32_t start;
    bool in, q;
} t37, t38;

static bool was37, was38;

/* An on-delay of 100 ms steps. */
static bool on_delay(struct timer *timer, bool in, uint32_t preset, uint32_t now)
{
    if (in && !timer->in) {
        timer->start = now / 100;
    }
    timer->in = in;
    timer->q = in && (timer->q || now / 100 - timer->start >= preset);
    return timer->q;
}

static void count(unsigned at)
{
    wr16(V + at, (uint16_t)(rd16(V + at) + 1));
}

void scan(uint32_t now)
{
    uint32_t seed = advance(V), random = seed ^ seed >> 15;
    wr32(V + 4, random);
    if (now == 0) {
        wr16(V + TABLE, 10);
    }
    unsigned full = 0;
    int sum = 0;
    for (int n = 0; n < 8; n++) {
        int level = rdint(V + LEVELS + 2 * n) + (int)(random & 31) - 15;
        random >>= 3;
        full >>= 1;
        if (level < 0) {
            level = 0;
        }
        if (level > 100) {
            level = 100;
            full |= 0x80;
        }
        wr16(V + LEVELS + 2 * n, (uint16_t)level);
        sum += level;
    }
    wr32(V + POINTER, 0x08000000u + LEVELS + 16);
    V[FULL] = (uint8_t)full;
    wr16(V + SUM, (uint16_t)sum);
    wr16(V + N, 9);
    wr16(V + MEAN, (uint16_t)(sum / 8));
    unsigned entries = rd16(V + TABLE + 2);
    if (entries < rd16(V + TABLE)) {
        memcpy(V + TABLE + 4 + 2 * entries, V + MEAN, 2);
        wr16(V + TABLE + 2, (uint16_t)++entries);
    }
    if (entries == 10) {
        memcpy(V + OLDEST, V + TABLE + 4, 2);
        memmove(V + TABLE + 4, V + TABLE + 6, 18);
        wr16(V + TABLE + 2, 9);
    }
    bool q = on_delay(&t37, full & 0xC0, 3, now);
    if (q && !was37) {
        count(STARTS);
    }
    was37 = q;
    q = on_delay(&t38, full & 0x20 || (full & 0x18) == 0x18, 4, now) && !(full & 4);
    put(V, 21, 0, q);
    if (!q && was38) {
        count(STOPS);
    }
    was38 = q;
}
