#include "../plc.h"

enum { IDLE = 1, FILL = 2, HEAT = 4, STIR = 8, WAIT = 16, DRAIN = 32, RINSE = 64, READY = 128 };

static unsigned active = IDLE;
static uint32_t since_heat, since_stir;

AREAS({"M", M, 36}, {"Q", Q, 1})

static void count(unsigned word, bool on)
{
    if (on) {
        wr16(M + word, (uint16_t)(rd16(M + word) + 1));
    }
}

static unsigned next_steps(void)
{
    unsigned on = 0, off = 0, in = I[0];
    if ((active & IDLE) && (in & 3) == 1) {
        off |= IDLE, on |= FILL;
    }
    if ((active & FILL) && (in & 0xC)) {
        off |= FILL, on |= HEAT | STIR;
    }
    if ((active & HEAT) && bit(M, 20, 1)) {
        off |= HEAT, on |= WAIT;
    }
    if ((active & WAIT) && (active & STIR) && bit(M, 20, 2)) {
        off |= WAIT | STIR, on |= DRAIN;
    }
    if ((active & DRAIN) && (in & 0x10)) {
        off |= DRAIN, on |= in & 0x20 ? RINSE : READY;
    }
    if ((active & RINSE) && (in & 0x40)) {
        off |= RINSE, on |= READY;
    }
    if ((active & READY) && (in & 0x80)) {
        off |= READY, on |= IDLE;
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
    if (entered & HEAT) {
        since_heat = since_stir = now;
    }
    if (entered & FILL) {
        put(M, 20, 0, true);
    }
    if (entered & DRAIN) {
        put(M, 20, 0, false);
    }
    put(M, 20, 1, (active & HEAT) && now - since_heat >= 5);
    put(M, 20, 2, (active & STIR) && now - since_stir >= 8);
    Q[0] = (uint8_t)active;
    count(30, active & IDLE);
    count(32, active & DRAIN);
    bool rinse = active & RINSE, was = bit(M, 21, 0);
    put(M, 21, 0, rinse);
    count(34, rinse & !was);
}
