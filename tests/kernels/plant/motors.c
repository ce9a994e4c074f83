#include "../plc.h"

/* An instance of FB 1. */
enum { INPUTS = 0, LIMIT = 2, OUTPUTS = 4, TICKS = 6, SECONDS = 8, STARTS = 12, OLD = 14, CURRENT = 16, HEAT = 20, MOTOR = 24 };
enum { START = 1, STOP = 2, FEEDBACK = 4, LOCK = 8, RUN = 1, FAULT = 2 };
/* An instance of FB 2. */
enum { COMMANDS = 0, READY = 2, RUNNING = 4, TOTAL = 6, MOTORS = 10, GROUP = MOTORS + 4 * MOTOR };

static uint8_t db1[GROUP], db2[GROUP], db3[GROUP], db10[14];

AREAS({"DB1.DB", db1, sizeof db1}, {"DB2.DB", db2, sizeof db2}, {"DB3.DB", db3, sizeof db3}, {"DB10.DB", db10, sizeof db10})

static void motor(uint8_t *m, unsigned inputs, int limit)
{
    m[INPUTS] = (uint8_t)inputs;
    wr16(m + LIMIT, (uint16_t)limit);
    bool run = m[OUTPUTS] & RUN, fault = m[OUTPUTS] & FAULT;
    if ((inputs & (STOP | LOCK)) || fault) {
        run = false;
    } else if (inputs & START) {
        run = true;
    }
    if (run && !bit(m, OLD, 0)) {
        wr16(m + STARTS, (uint16_t)(rd16(m + STARTS) + 1));
    }
    put(m, OLD, 0, run);
    int ticks = 0;
    if (run != ((inputs & FEEDBACK) != 0)) {
        ticks = rdint(m + TICKS) + 1;
        fault |= ticks > limit;
    }
    wr16(m + TICKS, (uint16_t)ticks);
    float current = rdreal(m + CURRENT);
    if (run) {
        wr32(m + SECONDS, rd32(m + SECONDS) + 1);
        current += (10.0f - current) * 0.1f;
    } else {
        current *= 0.8f;
    }
    wrreal(m + CURRENT, current);
    float heat = rdreal(m + HEAT) * 0.99f + current * current * 0.01f;
    if (heat > 80.0f) {
        fault = true;
    }
    if ((inputs & (START | STOP)) == (START | STOP)) {
        fault = false;
        heat *= 0.5f;
    }
    wrreal(m + HEAT, heat);
    m[OUTPUTS] = (uint8_t)((run ? RUN : 0) | (fault ? FAULT : 0));
}

static unsigned inputs(bool start, bool stop, bool feedback, bool lock)
{
    return (start ? START : 0) | (stop ? STOP : 0) | (feedback ? FEEDBACK : 0) | (lock ? LOCK : 0);
}

static void group(uint8_t *g, unsigned commands, bool ready)
{
    wr16(g + COMMANDS, (uint16_t)commands);
    put(g, READY, 0, ready);
    uint8_t *m1 = g + MOTORS, *m2 = m1 + MOTOR, *m3 = m2 + MOTOR, *m4 = m3 + MOTOR;
    motor(m1, inputs(commands & 1, commands & 2, (m1[OUTPUTS] & RUN) && (commands & 0xC), !ready), 5);
    motor(m2, inputs(commands & 0x10, commands & 0x20, m2[OUTPUTS] & RUN, m1[OUTPUTS] & FAULT), 7);
    motor(m3, inputs(commands & 0x100, commands & 0x200, (m3[OUTPUTS] & RUN) && (commands & 0xC00), false), 4);
    motor(m4, inputs(commands & 0x1000, (commands & 0x6000) == 0x6000, m4[OUTPUTS] & RUN, !(m3[OUTPUTS] & RUN)), 9);
    wr16(g + RUNNING, (uint16_t)((m1[OUTPUTS] & RUN) + (m2[OUTPUTS] & RUN) + (m3[OUTPUTS] & RUN) + (m4[OUTPUTS] & RUN)));
    wrreal(g + TOTAL, rdreal(m1 + CURRENT) + rdreal(m2 + CURRENT) + rdreal(m3 + CURRENT) + rdreal(m4 + CURRENT));
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t random = rd32(db10) + 1640531;
    wr32(db10, random);
    random ^= random >> 11;
    group(db1, random & 0xFFFF, random & 0x70000);
    group(db2, random >> 3 & 0xFFFF, true);
    group(db3, random >> 7 & 0xFFFF, rdint(db1 + RUNNING) > 0);
    wr16(db10 + 4, (uint16_t)(rdint(db1 + RUNNING) + rdint(db2 + RUNNING) + rdint(db3 + RUNNING)));
    float total = (rdreal(db1 + TOTAL) + rdreal(db2 + TOTAL) + rdreal(db3 + TOTAL)) * 0.4f;
    wrreal(db10 + 6, total);
    if (total > rdreal(db10 + 10)) {
        wrreal(db10 + 10, total);
    }
}
