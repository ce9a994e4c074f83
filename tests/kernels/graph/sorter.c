#include "../plc.h"

enum step { WAIT, MEASURE, LEFT, RIGHT, REJECT, PUSH, BACK };

static enum step step = WAIT;
static uint32_t since;

AREAS({"M", M, 34}, {"Q", Q, 2})

static void count(unsigned word, unsigned flag, bool on)
{
    bool was = bit(M, 21, flag);
    put(M, 21, flag, on);
    if (on && !was) {
        wr16(M + word, (uint16_t)(rd16(M + word) + 1));
    }
}

static enum step next_step(void)
{
    unsigned in = I[0];
    switch (step) {
    case WAIT: return in & 1 ? MEASURE : WAIT;
    case MEASURE: return !bit(M, 20, 0) ? MEASURE : !(in & 2) ? REJECT : in & 4 ? RIGHT : LEFT;
    case LEFT: return in & 8 ? PUSH : LEFT;
    case RIGHT: return in & 0x18 ? PUSH : RIGHT;
    case REJECT: return bit(M, 20, 1) ? BACK : REJECT;
    case PUSH: return bit(M, 20, 2) ? BACK : PUSH;
    default: return WAIT;
    }
}

void scan(uint32_t now)
{
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    memcpy(I, M + 4, 4);
    enum step before = step;
    step = next_step();
    if (step != before) {
        since = now;
    }
    uint32_t elapsed = now - since;
    put(M, 20, 0, step == MEASURE && elapsed >= 2);
    put(M, 20, 1, step == REJECT && elapsed >= 5);
    put(M, 20, 2, step == PUSH && elapsed >= 3);
    uint8_t out = (uint8_t)(step == BACK ? 0 : 1 << step);
    if (step == REJECT && elapsed >= 2) {
        out = 0;
    }
    Q[0] = out;
    if (step == LEFT) {
        Q[1] |= 1;
    }
    if (step == RIGHT) {
        Q[1] |= 2;
    }
    if (step == BACK) {
        Q[1] = 0;
    }
    count(30, 0, step == PUSH);
    count(32, 1, out == 16);
}
