#include "../plc.h"

enum { SEED = 0, MACHINES = 4, MACHINE = 10, STATE = 0, TICKS = 2, BOXES = 4, ORDER = 6, CODE = 8, ORDERS = MACHINES + 12 * MACHINE, DONE = ORDERS + 16 };

static uint8_t db1[DONE + 4] = {[ORDERS] = 0, 3, 0, 12, 0, 25, 0, 40, 0, 7, 0, 99, 0, 18, 0, 60};

AREAS({"DB1.DB", db1, sizeof db1})

static int first(int order)
{
    switch (order) {
    case 0 ... 9:
        return 20;
    case 10 ... 19:
    case 25:
        return 30;
    case 40:
    case 60:
        return 40;
    default:
        return 90;
    }
}

static void step(uint8_t *m, uint32_t bits)
{
    int was = rdint(m + STATE), state = was, ticks = rdint(m + TICKS) + 1;
    switch (was) {
    case 0:
        if ((bits & 7) == 5) {
            memcpy(m + ORDER, db1 + ORDERS + 2 * (rdint(m + BOXES) % 8), 2);
            state = 10;
        }
        break;
    case 10:
        state = first(rdint(m + ORDER));
        break;
    case 20:
    case 21:
    case 22:
        if (ticks > 2) {
            state++;
        }
        break;
    case 23:
        state = 50;
        break;
    case 30:
        if (bits & 0x18) {
            state = 31;
        }
        break;
    case 31:
        wr16(m + CODE, (uint16_t)(rdint(m + CODE) + rdint(m + ORDER)));
        state = 50;
        break;
    case 40 ... 44:
        state++;
        break;
    case 45:
        if (ticks > 8) {
            state = 50;
        }
        break;
    case 50:
        wr16(m + BOXES, (uint16_t)(rdint(m + BOXES) + 1));
        wr32(db1 + DONE, rd32(db1 + DONE) + 1);
        state = 0;
        break;
    case 90:
        if ((bits & 0x30) == 0x30) {
            wr16(m + BOXES, (uint16_t)(rdint(m + BOXES) + 1));
            state = 0;
        }
        break;
    default:
        state = 0;
        break;
    }
    wr16(m + STATE, (uint16_t)state);
    wr16(m + TICKS, (uint16_t)(state == was ? ticks : 0));
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(db1 + SEED);
    for (int i = 0; i < 12; i++) {
        seed += 1640531;
        step(db1 + MACHINES + MACHINE * i, seed ^ seed >> 9);
    }
    wr32(db1 + SEED, seed);
}
