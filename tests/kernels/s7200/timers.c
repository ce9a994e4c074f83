#include "../plc.h"

static uint8_t V[128] = {0x61, 0xC8, 0x86, 0x47};

AREAS({"V", V, 68}, {"M", M, 3}, {"Q", Q, 3})

struct timer {
    int16_t value;
    bool bit, input;
};

struct counter {
    int16_t value;
    bool bit, up, down;
};

static struct timer timers[24];
static struct counter counters[24];
static bool runs;

static bool is_off_delay(unsigned number)
{
    return number % 4 == 1;
}

/* Timers of 10 ms count when a scan begins, the others when they are executed. */
static bool is_fast(unsigned number)
{
    return number % 3 == 0;
}

static void advance_timer(struct timer *timer, bool off_delay, int preset, unsigned ticks)
{
    if (off_delay ? timer->input || !timer->bit : !timer->input) {
        return;
    }
    timer->value = (int16_t)(timer->value + ticks > INT16_MAX ? INT16_MAX : timer->value + ticks);
    if (off_delay) {
        if (timer->value >= preset) {
            timer->value = (int16_t)preset;
            timer->bit = false;
        }
    } else {
        timer->bit = timer->value >= preset;
    }
}

static void timer_box(struct timer *timer, bool off_delay, bool fast, bool on, int preset, unsigned ticks)
{
    if (!fast && on == timer->input) {
        advance_timer(timer, off_delay, preset, ticks);
    }
    if (off_delay) {
        if (on) {
            timer->value = 0;
            timer->bit = true;
        } else if (timer->input) {
            timer->value = 0;
        }
    } else if (!on) {
        timer->value = 0;
        timer->bit = false;
    }
    timer->input = on;
}

static void count(struct counter *counter, bool up, bool down, bool reset, int preset)
{
    if (reset) {
        counter->value = 0;
    } else if (runs) {
        counter->value = (int16_t)(counter->value + (up & !counter->up) - (down & !counter->down));
    }
    counter->bit = counter->value >= preset;
    counter->up = up;
    counter->down = down;
}

void scan(uint32_t now)
{
    unsigned last = now == 0 ? 0 : now - 1, ticks10 = now / 10 - last / 10, ticks100 = now / 100 - last / 100;
    if (ticks10 != 0) {
        for (unsigned i = 0; i < 24; i += 3) {
            advance_timer(&timers[i], is_off_delay(i), (int)(2 + i % 5), ticks10);
        }
    }
    wr32(V + 4, advance(V));
    wr16(V + 8, (uint16_t)(rd16(V + 8) + 1));
    for (unsigned i = 0; i < 24; i++) {
        struct timer *timer = &timers[i];
        bool on = bit(V, 8 + i % 2, i % 2 ? i * 3 % 8 : 0) | bit(V, 4 + i % 4, i % 8);
        timer_box(timer, is_off_delay(i), is_fast(i), on, (int)(2 + i % 5), ticks100);
        bool up = timer->bit & !bit(V, 4 + (i + 1) % 4, (i + 3) % 8);
        put(Q, i / 8, i % 8, up);
        struct counter *counter = &counters[i];
        bool down = bit(V, 4 + (i + 2) % 4, (i + 5) % 8) & bit(V, 4 + (i + 3) % 4, (i + 1) % 8);
        count(counter, up, down, counter->value >= (int)(10 + i), (int)(30 + i));
        put(M, i / 8, i % 8, counter->bit);
        wr16(V + 20 + 2 * i, (uint16_t)counter->value);
    }
    runs = true;
}
