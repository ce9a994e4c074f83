/* TON, TOF and TP for the twins of kernels with IEC timers. Times are in milliseconds; each function returns Q. */
#ifndef IEC_H
#define IEC_H

#include <stdbool.h>
#include <stdint.h>

struct timer {
    uint32_t start, elapsed;
    bool in, q, running;
};

static inline bool on_delay(struct timer *timer, bool in, uint32_t preset, uint32_t now)
{
    if (!in) {
        timer->elapsed = 0;
        timer->q = false;
    } else {
        if (!timer->in) {
            timer->start = now;
        }
        if (!timer->q) {
            timer->elapsed = now - timer->start;
            if (timer->elapsed >= preset) {
                timer->elapsed = preset;
                timer->q = true;
            }
        }
    }
    timer->in = in;
    return timer->q;
}

static inline bool off_delay(struct timer *timer, bool in, uint32_t preset, uint32_t now)
{
    if (in) {
        timer->q = true;
        timer->elapsed = 0;
        timer->running = false;
    } else {
        if (timer->in) {
            timer->start = now;
            timer->running = true;
        }
        if (timer->running) {
            timer->elapsed = now - timer->start;
            if (timer->elapsed >= preset) {
                timer->elapsed = preset;
                timer->running = false;
                timer->q = false;
            }
        }
    }
    timer->in = in;
    return timer->q;
}

static inline bool pulse(struct timer *timer, bool in, uint32_t preset, uint32_t now)
{
    if (in && !timer->in && !timer->q) {
        timer->start = now;
        timer->q = true;
        timer->elapsed = 0;
    }
    if (timer->q) {
        timer->elapsed = now - timer->start;
        if (timer->elapsed >= preset) {
            timer->elapsed = preset;
            timer->q = false;
        }
    }
    if (!timer->q && !in) {
        timer->elapsed = 0;
    }
    timer->in = in;
    return timer->q;
}

#endif
