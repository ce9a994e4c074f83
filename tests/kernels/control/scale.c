#include "../plc.h"

enum { RAW = 0, LOW = 2, HIGH = 6, VALUE = 10, ERROR = 14, OUT = 16, FLAGS = 18, SIZE = 20, WARNINGS = 16 * SIZE };

// Limits of -20 and 120.
#define CHANNEL 0, 0, 0xC1, 0xA0, 0, 0, 0x42, 0xF0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0
#define FOUR CHANNEL, CHANNEL, CHANNEL, CHANNEL

static uint8_t db[WARNINGS + 2] = {FOUR, FOUR, FOUR, FOUR};

AREAS({"M", M, 8}, {"DB1.DB", db, sizeof db})

static int scale(int in, float high, float low, float *out)
{
    float value = (float)in;
    if (value < 0.0f) {
        *out = low;
        return 8;
    }
    if (value > 27648.0f) {
        *out = high;
        return 8;
    }
    *out = value / 27648.0f * (high - low) + low;
    return 0;
}

static int unscale(float in, float high, float low, int *out)
{
    if (in < low) {
        *out = 0;
        return 8;
    }
    if (in > high) {
        *out = 27648;
        return 8;
    }
    *out = (int)lrintf((in - low) / (high - low) * 27648.0f);
    return 0;
}

void scan(uint32_t now)
{
    (void)now;
    int warnings = 0;
    for (int i = 0; i < 16; i++) {
        uint8_t *a = db + SIZE * i;
        uint32_t random = rd32(M) + 0x9E3779B9u;
        wr32(M, random);
        random ^= random >> 15;
        wr32(M + 4, random);
        int raw = random >> 16 & 0x6FFF, out;
        float value;
        wr16(a + RAW, (uint16_t)raw);
        int error = scale(raw, rdreal(a + HIGH), rdreal(a + LOW), &value);
        wrreal(a + VALUE, value);
        bool warn = value > 90.0f || (value >= 85.0f && bit(a, FLAGS, 0));
        a[FLAGS] = (uint8_t)(warn | (value > 110.0f) << 1 | (error != 0) << 2);
        warnings += warn;
        wr16(a + ERROR, (uint16_t)unscale(value * 0.5f, 100.0f, 0.0f, &out));
        wr16(a + OUT, (uint16_t)out);
    }
    wr16(db + WARNINGS, (uint16_t)warnings);
}
