#include "../plc.h"

enum { IDLE, FILLING, HEATING, STIRRING, DRAINING, RINSING, HALTED };
enum { MACHINE = 4, MACHINES = 16, STATE = 0, TIMER = 1, PARTS = 2, FAULTS = MACHINE * MACHINES };

static uint8_t db1[FAULTS + 2];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 4})

static void enter(uint8_t *m, uint8_t state, unsigned timer)
{
    m[STATE] = state;
    m[TIMER] = (uint8_t)timer;
}

static void step(uint8_t *m, unsigned bits)
{
    switch (m[STATE]) {
    case IDLE:
        if ((bits & 3) == 3) {
            enter(m, FILLING, 5);
        }
        break;
    case FILLING:
        if (--m[TIMER] == 0) {
            enter(m, HEATING, (bits >> 3 & 7) + 1);
        }
        break;
    case HEATING:
        if ((bits & 0x0FFF) == 0) {
            m[STATE] = HALTED;
            wr16(db1 + FAULTS, (uint16_t)(rd16(db1 + FAULTS) + 1));
        } else if (--m[TIMER] == 0) {
            enter(m, STIRRING, 4);
        }
        break;
    case STIRRING:
        if (--m[TIMER] == 0) {
            enter(m, DRAINING, 3);
        }
        break;
    case DRAINING:
        if (--m[TIMER] == 0) {
            unsigned parts = (uint16_t)(rd16(m + PARTS) + 1);
            wr16(m + PARTS, (uint16_t)parts);
            m[STATE] = parts % 8 == 0 ? RINSING : IDLE;
        }
        break;
    case RINSING:
        if (bits & 0x10) {
            m[STATE] = IDLE;
        }
        break;
    case HALTED:
        if ((bits & 0xC) == 0xC) {
            m[STATE] = IDLE;
        }
        break;
    default:
        m[STATE] = HALTED;
        break;
    }
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M);
    for (uint8_t *m = db1; m < db1 + FAULTS; m += MACHINE) {
        seed += 0x9E3779B9u;
        step(m, (uint16_t)(seed ^ seed >> 15));
    }
    wr32(M, seed);
}
