#include "../plc.h"

enum { SEED = 0, X = 4, Y = 68, RAW = 132, RESULT = 148, ERROR = 180, READY = 184 };

static uint8_t db1[READY + 2];

AREAS({"DB1.DB", db1, sizeof db1})

static float point(unsigned array, int i)
{
    return rdreal(db1 + array + 4 * i);
}

static float interpolate(float at)
{
    if (at <= point(X, 0)) {
        return point(Y, 0);
    }
    if (at >= point(X, 15)) {
        return point(Y, 15);
    }
    int i = 1;
    while (i < 15 && at > point(X, i)) {
        i++;
    }
    return point(Y, i - 1) + (at - point(X, i - 1)) * (point(Y, i) - point(Y, i - 1)) / (point(X, i) - point(X, i - 1));
}

void scan(uint32_t now)
{
    (void)now;
    if (!bit(db1, READY, 0)) {
        for (int i = 0; i < 16; i++) {
            wrreal(db1 + X + 4 * i, (float)(i * i) * 2.0f);
            wrreal(db1 + Y + 4 * i, (float)i * 1.5f + 3.0f);
        }
        put(db1, READY, 0, true);
    }
    float error = 0;
    int32_t seed = rddint(db1 + SEED);
    for (int i = 0; i < 8; i++) {
        seed = (seed * 421 + 1663) % 7875;
        wr16(db1 + RAW + 2 * i, (uint16_t)seed);
        float value = (float)(int16_t)seed / 16.0f, result = interpolate(value);
        wrreal(db1 + RESULT + 4 * i, result);
        error += (result - value) * (result - value);
    }
    wr32(db1 + SEED, (uint32_t)seed);
    wrreal(db1 + ERROR, error);
}
