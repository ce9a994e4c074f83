#include "../plc.h"

AREAS({"M", M, 104}, {"Q", Q, 8})

struct counter {
    int16_t value;
    bool up, down;
};

static struct counter counters[32];

static void count_up(struct counter *counter, bool on)
{
    if (on && !counter->up && counter->value < 999) {
        counter->value++;
    }
    counter->up = on;
}

static void count_down(struct counter *counter, bool on)
{
    if (on && !counter->down && counter->value > 0) {
        counter->value--;
    }
    counter->down = on;
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t random = next(M);
    wr32(M + 4, rd32(M) ^ rd32(M) >> 15);
    wr32(I, random);
    for (unsigned i = 0; i < 32; i++) {
        unsigned b = i / 8, x = i % 8;
        struct counter *counter = &counters[i];
        bool part = bit(I, b, x);
        count_up(counter, part);
        count_down(counter, bit(I, (b + 2) % 4, 7 - x) & !part);
        wr16(M + 20 + 2 * i, (uint16_t)counter->value);
        bool full = counter->value >= (int)(20 + i);
        if (full) {
            counter->value = 0;
        }
        put(Q, b, x, full);
        bool was = bit(M, 90 + b, x);
        put(M, 90 + b, x, full);
        if (full & !was) {
            wr32(M + 100, rd32(M + 100) + i + 1);
        }
        put(Q, 4 + b, x, counter->value != 0);
    }
}
