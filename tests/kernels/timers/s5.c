#include "../plc.h"

AREAS({"M", M, 128}, {"Q", Q, 12})

/* A timer: `until` when it ends, `left` its value in units of 10 ms while it does not run. */
struct timer {
    uint32_t until;
    uint16_t left;
    bool running, status, edge;
};

struct counter {
    int16_t value;
    bool up, down, set;
};

static struct timer timers[96];
static struct counter counters[24];

static void settle(struct timer *timer, uint32_t now, bool after)
{
    if (timer->running && now >= timer->until) {
        timer->running = false;
        timer->left = 0;
        timer->status = after;
    }
}

static uint16_t left(const struct timer *timer, uint32_t now)
{
    return timer->running ? (uint16_t)((timer->until - now + 9) / 10) : timer->left;
}

static void run(struct timer *timer, uint32_t now, uint16_t units)
{
    timer->until = now + 10 * units;
    timer->running = true;
}

static void freeze(struct timer *timer, uint32_t now)
{
    timer->left = left(timer, now);
    timer->running = false;
}

static void on_delay(struct timer *timer, uint32_t now, bool on, uint16_t units)
{
    settle(timer, now, true);
    if (on && !timer->edge) {
        timer->status = false;
        run(timer, now, units);
    } else if (!on && timer->edge) {
        freeze(timer, now);
        timer->status = false;
    }
    timer->edge = on;
}

static void off_delay(struct timer *timer, uint32_t now, bool on, uint16_t units)
{
    settle(timer, now, false);
    if (on && !timer->edge) {
        freeze(timer, now);
        timer->status = true;
    } else if (!on && timer->edge) {
        timer->status = true;
        run(timer, now, units);
    }
    timer->edge = on;
}

static void pulse(struct timer *timer, uint32_t now, bool on, uint16_t units)
{
    settle(timer, now, false);
    if (on && !timer->edge) {
        timer->status = true;
        run(timer, now, units);
    } else if (!on && timer->edge) {
        freeze(timer, now);
        timer->status = false;
    }
    timer->edge = on;
}

static void count(struct counter *counter, bool up, bool down)
{
    if (up && !counter->up && counter->value < 999) {
        counter->value++;
    }
    counter->up = up;
    if (down && !counter->down && counter->value > 0) {
        counter->value--;
    }
    counter->down = down;
}

static void preset(struct counter *counter, bool on, int16_t value)
{
    if (on && !counter->set) {
        counter->value = value;
    }
    counter->set = on;
}

void scan(uint32_t now)
{
    uint32_t random = next(M);
    wr32(M + 4, rd32(M) ^ rd32(M) >> 15);
    wr32(I, random);
    for (unsigned i = 0; i < 24; i++) {
        unsigned b = i / 8, x = i % 8;
        struct timer *delay = &timers[4 * i], *off = delay + 1, *short_pulse = delay + 2;
        struct counter *counter = &counters[i];
        on_delay(delay, now, bit(I, b, x), (uint16_t)(3 + i % 5));
        put(Q, b, x, delay->status);
        off_delay(off, now, delay->status & !bit(I, (b + 1) % 4, x), (uint16_t)(7 + i % 3));
        pulse(short_pulse, now, bit(I, 3 - b, x), 5);
        bool on = off->status & !short_pulse->status;
        put(Q, 4 + b, x, on);
        count(counter, short_pulse->status, on);
        preset(counter, counter->value == 0, (int16_t)(5 + i % 7));
        wr16(M + 20 + 2 * i, (uint16_t)counter->value);
        wr16(M + 80 + 2 * i, left(delay, now));
        put(Q, 8 + b, x, counter->value != 0);
    }
}
