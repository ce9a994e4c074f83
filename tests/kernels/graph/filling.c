#include "../plc.h"

enum {
    IDLE, TAKE, LIFT, TURN, PLACE, OPEN, FILL, CLOSE, LABEL, PUMP, MIX, HEAT, STIR, COOL, DRAIN, JOIN, CHECK, GOOD, SCRAP, RINSE, NOT_YET
};

/* A line that is on one of its steps, or has none: the first also does what comes before and after both. */
static struct line {
    unsigned step;
    uint32_t since;
} first = {NOT_YET, 0}, second = {NOT_YET, 0};

AREAS({"M", M, 34}, {"Q", Q, 3})

static unsigned next_step(unsigned step)
{
    uint32_t in = I[0] | I[1] << 8 | I[2] << 16 | (uint32_t)I[3] << 24;
    unsigned flags = M[20];
    switch (step) {
    case TAKE: return in & 0x24 ? LIFT : TAKE;
    case LIFT: return in & 0x48 ? TURN : LIFT;
    case TURN: return in & 0x90 ? PLACE : TURN;
    case PLACE: return flags & 0x10 ? OPEN : PLACE;
    case OPEN: return in & 0x240 ? FILL : OPEN;
    case FILL: return in & 0x480 ? CLOSE : FILL;
    case CLOSE: return in & 0x900 ? LABEL : CLOSE;
    case PUMP: return flags & 2 ? MIX : PUMP;
    case MIX: return in & 0x12000 ? HEAT : MIX;
    case HEAT: return in & 0x24000 ? STIR : HEAT;
    case STIR: return in & 0x48000 ? COOL : STIR;
    case COOL: return in & 0x90000 ? DRAIN : COOL;
    case JOIN: return in & 0x4000000 ? CHECK : JOIN;
    case CHECK: return in & 0x10000000 ? SCRAP : in & 0x8000000 ? GOOD : CHECK;
    case GOOD: return in & 0x60000000 ? RINSE : GOOD;
    case SCRAP: return !(in & 0x80000000) ? RINSE : SCRAP;
    case RINSE: return flags & 8 ? IDLE : RINSE;
    default: return step;
    }
}

static void enter(struct line *line, unsigned step, uint32_t now)
{
    if (step != line->step) {
        line->step = step;
        line->since = now;
    }
}

static uint32_t outputs(const struct line *line, uint32_t now)
{
    uint32_t elapsed = now - line->since;
    unsigned limit = 0;
    switch (line->step) {
    case NOT_YET: case PLACE: case PUMP: case DRAIN: case RINSE: return 0;
    case TURN: limit = 5; break;
    case LABEL: limit = 2; break;
    case COOL: limit = 3; break;
    case SCRAP: limit = 4; break;
    default: return 1u << line->step;
    }
    return elapsed < limit ? 1u << line->step : 0;
}

void scan(uint32_t now)
{
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    memcpy(I, M + 4, 4);
    if (first.step == NOT_YET) {
        enter(&first, IDLE, now);
    } else if (first.step == IDLE) {
        if ((I[0] & 3) == 3) {
            enter(&first, TAKE, now);
            enter(&second, PUMP, now);
        }
    } else if (first.step == LABEL && second.step == DRAIN && (I[3] & 3)) {
        enter(&first, JOIN, now);
        second.step = NOT_YET;
    } else {
        enter(&first, next_step(first.step), now);
        enter(&second, next_step(second.step), now);
    }
    uint32_t out = outputs(&first, now) | outputs(&second, now);
    Q[0] = (uint8_t)out;
    Q[1] = (uint8_t)(out >> 8);
    Q[2] = (uint8_t)(out >> 16);
    if (first.step == OPEN || first.step == CLOSE) {
        put(M, 21, 0, first.step == OPEN);
    }
    if (second.step == HEAT || second.step == COOL) {
        put(M, 21, 1, second.step == HEAT);
    }
    uint32_t first_elapsed = now - first.since, second_elapsed = now - second.since;
    put(M, 20, 1, second.step == PUMP && second_elapsed >= 2);
    put(M, 20, 3, first.step == RINSE && first_elapsed >= 3);
    put(M, 20, 4, first.step == PLACE && first_elapsed >= 3);
    put(M, 20, 6, second.step == DRAIN && second_elapsed >= 4);
    if (first.step == IDLE) {
        wr16(M + 30, (uint16_t)(rd16(M + 30) + 1));
    }
    bool open = bit(M, 21, 0), was = bit(M, 22, 0);
    put(M, 22, 0, open);
    if (!open && was) {
        wr16(M + 32, (uint16_t)(rd16(M + 32) + 1));
    }
}
