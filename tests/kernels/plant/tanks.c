#include "../plc.h"

enum { LEVEL = 0, FLOW = 4, HOURS = 8, FLAGS = 12, TANK = 14 };
enum { LOW = 1, HIGH = 2, PUMP = 4, ALARM = 8, OLD = 16, LOCKED = 32 };
enum { COMMANDS = 0, INFLOW = 2, RUNNING = 6, ALARMS = 8, VOLUME = 10, TANKS = 14 };

static uint8_t db1[TANKS + 6 * TANK], db2[8];

AREAS({"DB1.DB", db1, sizeof db1}, {"DB2.DB", db2, sizeof db2})

void scan(uint32_t now)
{
    (void)now;
    int32_t seed = (rddint(db2) * 421 + 1663) % 7875;
    wr32(db2, (uint32_t)seed);
    float inflow = (float)(seed % 64) * 0.08f, volume = 0;
    wr16(db1 + COMMANDS, (uint16_t)seed);
    wrreal(db1 + INFLOW, inflow);
    int running = 0, alarms = rdint(db1 + ALARMS);
    for (int i = 1; i <= 6; i++) {
        uint8_t *tank = db1 + TANKS + TANK * (i - 1);
        float level = rdreal(tank + LEVEL), flow = rdreal(tank + FLOW);
        bool low = level < 20.0f, high = level > 80.0f, locked = i > 1 && low, pump = tank[FLAGS] & PUMP;
        if (high) {
            pump = true;
        } else if (low || locked) {
            pump = false;
        } else if (seed >> i & 1) {
            pump = !pump;
        }
        if (pump) {
            running++;
            wr32(tank + HOURS, rd32(tank + HOURS) + 1);
            flow += (5.0f - flow) * 0.2f;
        } else {
            flow *= 0.5f;
        }
        wrreal(tank + FLOW, flow);
        bool alarm = (high && !pump) || level > 95.0f;
        if (alarm && !(tank[FLAGS] & OLD)) {
            alarms++;
        }
        tank[FLAGS] = (uint8_t)((low ? LOW : 0) | (high ? HIGH : 0) | (pump ? PUMP : 0) | (alarm ? ALARM | OLD : 0) | (locked ? LOCKED : 0));
        level = level + inflow - flow;
        level = level < 0.0f ? 0.0f : level > 100.0f ? 100.0f : level;
        wrreal(tank + LEVEL, level);
        volume += level;
    }
    wr16(db1 + RUNNING, (uint16_t)running);
    wr16(db1 + ALARMS, (uint16_t)alarms);
    wrreal(db1 + VOLUME, volume);
    wrreal(db2 + 4, volume / 6.0f);
}
