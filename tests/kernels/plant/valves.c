#include "../plc.h"

/* An instance of FB 2: inputs, output, eight valves of 10 bytes. */
enum { COMMANDS = 0, FEEDBACK = 2, FAULTS = 4, VALVES = 6, VALVE = 12 };
/* A valve: bits in three bytes, and words. */
enum { INPUTS = 0, LIMIT = 2, OUTPUTS = 4, CYCLES = 6, STATES = 8, TICKS = 10 };
enum { OPEN = 1, CLOSE = 2, IS_OPEN = 4, IS_CLOSED = 8 };
enum { COIL = 1, FAULT = 2 };
enum { EDGE = 1, MOVING = 2 };

static uint8_t db1[VALVES + 8 * VALVE], db2[VALVES + 8 * VALVE];

AREAS({"DB1.DB", db1, sizeof db1}, {"DB2.DB", db2, sizeof db2}, {"M", M, 12})

static void valve(uint8_t *v, unsigned inputs, int limit)
{
    v[INPUTS] = (uint8_t)inputs;
    wr16(v + LIMIT, (uint16_t)limit);
    bool coil = v[OUTPUTS] & COIL, fault = v[OUTPUTS] & FAULT;
    if ((inputs & OPEN) && !fault) {
        coil = true;
    }
    if ((inputs & CLOSE) || fault) {
        coil = false;
    }
    if (coil && !(v[STATES] & EDGE)) {
        wr16(v + CYCLES, (uint16_t)(rd16(v + CYCLES) + 1));
    }
    bool moving = coil ? !(inputs & IS_OPEN) : !(inputs & IS_CLOSED);
    int ticks = 0;
    if (moving) {
        ticks = rdint(v + TICKS) + 1;
        fault |= ticks > limit;
    }
    wr16(v + TICKS, (uint16_t)ticks);
    if ((inputs & OPEN) && (inputs & CLOSE)) {
        fault = false;
    }
    v[OUTPUTS] = (uint8_t)((coil ? COIL : 0) | (fault ? FAULT : 0));
    v[STATES] = (uint8_t)((coil ? EDGE : 0) | (moving ? MOVING : 0));
}

static void group(uint8_t *db, unsigned commands, unsigned feedback)
{
    wr16(db + COMMANDS, (uint16_t)commands);
    wr16(db + FEEDBACK, (uint16_t)feedback);
    int faults = 0;
    for (int i = 0; i < 8; i++) {
        uint8_t *v = db + VALVES + VALVE * i;
        unsigned inputs = (commands >> (8 + i) & 1) | (commands >> i & 1) << 1 | (feedback >> (8 + i) & 1) << 2 | (feedback >> i & 1) << 3;
        valve(v, inputs, 3 + i);
        faults += (v[OUTPUTS] & FAULT) != 0;
    }
    wr16(db + FAULTS, (uint16_t)faults);
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    group(db1, rd16(M + 4), rd16(M + 6));
    memcpy(M + 8, db1 + FAULTS, 2);
    group(db2, rd16(M + 6), rd16(M + 5));
    memcpy(M + 10, db2 + FAULTS, 2);
}
