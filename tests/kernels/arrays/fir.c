#include "../plc.h"

enum { TAPS = 0, RING = 128, PLACE = 256, PHASE = 258, FILTERED = 260, AVERAGE = 264, DEVIATION = 268 };

static uint8_t db1[DEVIATION + 4];

AREAS({"DB1.DB", db1, sizeof db1})

static float element(unsigned array, int index)
{
    return rdreal(db1 + array + 4 * index);
}

static float wave(int phase)
{
    return (float)(phase < 50 ? phase : 100 - phase) * 0.5f;
}

void scan(uint32_t now)
{
    (void)now;
    if (element(TAPS, 0) == 0) {
        for (int i = 0; i < 32; i++) {
            wrreal(db1 + TAPS + 4 * i, (float)(i * (32 - i) + 1) / 2048.0f);
        }
    }
    int phase = (rdint(db1 + PHASE) + 1) % 100;
    wr16(db1 + PHASE, (uint16_t)phase);
    int place = rdint(db1 + PLACE) + 1;
    if (place > 31) {
        place = 0;
    }
    wr16(db1 + PLACE, (uint16_t)place);
    wrreal(db1 + RING + 4 * place, wave(phase));
    float sum = 0;
    int at = place;
    for (int i = 0; i < 32; i++) {
        sum += element(TAPS, i) * element(RING, at);
        if (--at < 0) {
            at = 31;
        }
    }
    wrreal(db1 + FILTERED, sum);
    float mean = 0;
    at = place;
    for (int i = 1; i <= 16; i++) {
        mean += element(RING, at);
        at = (at + 31) % 32;
    }
    mean /= 16.0f;
    wrreal(db1 + AVERAGE, mean);
    sum = 0;
    for (int i = 0; i < 32; i++) {
        float difference = element(RING, i) - mean;
        sum += difference * difference;
    }
    wrreal(db1 + DEVIATION, sqrtf(sum / 31.0f));
}
