#include "../plc.h"

enum { STATE = 0, FLOOR = 2, GOAL = 4, TICKS = 6, RIDES = 8, FLAGS = 12, LIFT = 14 };
enum { DOOR = 1, UP = 2 };
enum { SEED = 0, LIFTS = 4, CALLS = LIFTS + 4 * LIFT };

static uint8_t db1[CALLS + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static int nearest(unsigned calls, int floor)
{
    for (int distance = 0; distance <= 7; distance++) {
        if (floor + distance <= 7 && (calls >> (floor + distance) & 1)) {
            return floor + distance;
        }
        if (floor - distance >= 0 && (calls >> (floor - distance) & 1)) {
            return floor - distance;
        }
    }
    return -1;
}

static unsigned step(uint8_t *lift, unsigned calls)
{
    int state = rdint(lift + STATE), floor = rdint(lift + FLOOR), ticks = rdint(lift + TICKS);
    switch (state) {
    case 0: {
        int goal = nearest(calls, floor);
        wr16(lift + GOAL, (uint16_t)goal);
        if (goal >= 0) {
            calls &= ~(1u << goal);
            wr16(lift + TICKS, 0);
            if (goal == floor) {
                wr16(lift + STATE, 2);
            } else {
                lift[FLAGS] = (uint8_t)((lift[FLAGS] & ~UP) | (goal > floor ? UP : 0));
                wr16(lift + STATE, 1);
            }
        }
        break;
    }
    case 1:
        if (++ticks >= 3) {
            ticks = 0;
            floor += lift[FLAGS] & UP ? 1 : -1;
            wr16(lift + FLOOR, (uint16_t)floor);
            if (floor == rdint(lift + GOAL)) {
                wr16(lift + STATE, 2);
            }
        }
        wr16(lift + TICKS, (uint16_t)ticks);
        break;
    case 2:
        lift[FLAGS] |= DOOR;
        wr16(lift + TICKS, 0);
        wr16(lift + STATE, 3);
        break;
    case 3:
    case 4:
        if (++ticks > 5) {
            wr16(lift + STATE, (uint16_t)(state + 1));
            ticks = 0;
        }
        wr16(lift + TICKS, (uint16_t)ticks);
        break;
    case 5:
        lift[FLAGS] &= (uint8_t)~DOOR;
        wr32(lift + RIDES, rd32(lift + RIDES) + 1);
        wr16(lift + STATE, 0);
        break;
    default:
        wr16(lift + STATE, 0);
        break;
    }
    return calls;
}

void scan(uint32_t now)
{
    (void)now;
    int32_t seed = (rddint(db1 + SEED) * 421 + 1663) % 7875;
    wr32(db1 + SEED, (uint32_t)seed);
    unsigned calls = rd16(db1 + CALLS);
    if (seed % 3 == 0) {
        calls |= 1u << seed % 8;
    }
    for (int i = 0; i < 4; i++) {
        calls = step(db1 + LIFTS + LIFT * i, calls);
    }
    wr16(db1 + CALLS, (uint16_t)calls);
}
