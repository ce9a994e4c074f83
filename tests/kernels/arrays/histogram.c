#include "../plc.h"

enum { READINGS = 64, CLASSES = 16 };
enum { COUNTS = 2 * READINGS, CUMULATED = COUNTS + 4 * CLASSES, MEDIAN = CUMULATED + 4 * CLASSES, LOW = MEDIAN + 2 };
enum { HIGH = LOW + 2, SUM = HIGH + 2, SQUARES = SUM + 4 };

static uint8_t db[SQUARES + 8];

AREAS({"M", M, 4}, {"DB1.DB", db, sizeof db})

static void wrlreal(uint8_t *at, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    wr32(at, (uint32_t)(bits >> 32));
    wr32(at + 4, (uint32_t)bits);
}

void scan(uint32_t now)
{
    (void)now;
    memmove(db + 2, db, 2 * (READINGS - 1));
    uint32_t seed = rd32(M) * 1664525u + 1013904223u;
    wr32(M, seed);
    wr16(db, (uint16_t)((seed >> 21) - 500));
    memset(db + COUNTS, 0, 4 * CLASSES);
    int low = 32767, high = -32768, sum = 0;
    double squares = 0;
    for (int i = 0; i < READINGS; i++) {
        int value = rdint(db + 2 * i), number = value / 64;
        number = number < 0 ? 0 : number > 15 ? 15 : number;
        uint8_t *count = db + COUNTS + 4 * number;
        wr32(count, rd32(count) + 1);
        low = value < low ? value : low;
        high = value > high ? value : high;
        sum += value;
        squares += (double)value * value;
    }
    wr16(db + LOW, (uint16_t)low);
    wr16(db + HIGH, (uint16_t)high);
    wr32(db + SUM, (uint32_t)sum);
    wrlreal(db + SQUARES, squares);
    int32_t total = 0;
    for (int i = 0; i < CLASSES; i++) {
        total += rddint(db + COUNTS + 4 * i);
        wr32(db + CUMULATED + 4 * i, (uint32_t)total);
    }
    int median = 0;
    while (median < CLASSES - 1 && rddint(db + CUMULATED + 4 * median) < total / 2) {
        median++;
    }
    wr16(db + MEDIAN, (uint16_t)median);
}
