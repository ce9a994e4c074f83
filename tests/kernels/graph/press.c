#include "../plc.h"

enum { READY = 1, DOWN = 2, HOLD = 4, UP = 8, FEED = 16, CLAMP = 32, OIL = 64, DONE = 128 };

static unsigned active;
static uint32_t since_hold, since_oil;

AREAS({"M", M, 34}, {"Q", Q, 1})

static void count(unsigned word, bool on)
{
    if (on) {
        wr16(M + word, (uint16_t)(rd16(M + word) + 1));
    }
}

static unsigned next_steps(void)
{
    if (active == 0) {
        return READY;
    }
    unsigned on = 0, off = 0, in = I[0];
    if ((active & READY) && (in & 3)) {
        off |= READY, on |= DOWN | FEED | OIL;
    }
    if ((active & DOWN) && (in & 4)) {
        off |= DOWN, on |= HOLD;
    }
    if ((active & HOLD) && bit(M, 20, 1)) {
        off |= HOLD, on |= UP;
    }
    if ((active & FEED) && (in & 0x18) == 8) {
        off |= FEED, on |= CLAMP;
    }
    if ((active & UP) && (active & CLAMP) && (active & OIL) && (in & 0x20)) {
        off |= UP | CLAMP | OIL, on |= DONE;
    }
    if ((active & DONE) && ((in & 0x40) || !bit(M, 20, 0))) {
        off |= DONE, on |= READY;
    }
    return (active & ~off) | on;
}

void scan(uint32_t now)
{
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    memcpy(I, M + 4, 4);
    unsigned before = active;
    active = next_steps();
    unsigned entered = active & ~before;
    if (entered & HOLD) {
        since_hold = now;
    }
    if (entered & OIL) {
        since_oil = now;
    }
    if (active & DOWN) {
        put(M, 20, 0, true);
    }
    if (active & UP) {
        put(M, 20, 0, false);
    }
    if (active & CLAMP) {
        put(M, 20, 2, true);
    }
    if (active & DONE) {
        put(M, 20, 2, false);
    }
    put(M, 20, 1, (active & HOLD) && now - since_hold >= 6);
    unsigned out = active & ~(HOLD | OIL);
    out |= (active & HOLD) && now - since_hold < 4 ? HOLD : 0;
    out |= (active & OIL) && now - since_oil < 3 ? OIL : 0;
    Q[0] = (uint8_t)out;
    count(30, active & READY);
    bool clamped = bit(M, 20, 2), was = bit(M, 21, 0);
    put(M, 21, 0, clamped);
    count(32, !clamped && was);
}
