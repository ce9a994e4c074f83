#include "../plc.h"

enum { CHANNELS = 12, CHANNEL = 26, SCALED = 0, FILTERED = 4, RAMP = 8, TARGET = 12, FACTOR = 16, RATE = 20, STATE = 24, ALARMS = 25 };

static uint8_t db1[CHANNELS * CHANNEL];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 8})

/* The values of the data block when the program is loaded. */
__attribute__((constructor)) static void load(void)
{
    wrreal(db1 + CHANNEL * 0 + TARGET, 20.0f);
    wrreal(db1 + CHANNEL * 0 + FACTOR, 0.02f);
    wrreal(db1 + CHANNEL * 0 + RATE, 0.10f);
    wrreal(db1 + CHANNEL * 1 + TARGET, 25.0f);
    wrreal(db1 + CHANNEL * 1 + FACTOR, 0.03f);
    wrreal(db1 + CHANNEL * 1 + RATE, 0.15f);
    wrreal(db1 + CHANNEL * 2 + TARGET, 30.0f);
    wrreal(db1 + CHANNEL * 2 + FACTOR, 0.04f);
    wrreal(db1 + CHANNEL * 2 + RATE, 0.20f);
    wrreal(db1 + CHANNEL * 3 + TARGET, 35.0f);
    wrreal(db1 + CHANNEL * 3 + FACTOR, 0.05f);
    wrreal(db1 + CHANNEL * 3 + RATE, 0.25f);
    wrreal(db1 + CHANNEL * 4 + TARGET, 40.0f);
    wrreal(db1 + CHANNEL * 4 + FACTOR, 0.06f);
    wrreal(db1 + CHANNEL * 4 + RATE, 0.30f);
    wrreal(db1 + CHANNEL * 5 + TARGET, 45.0f);
    wrreal(db1 + CHANNEL * 5 + FACTOR, 0.07f);
    wrreal(db1 + CHANNEL * 5 + RATE, 0.35f);
    wrreal(db1 + CHANNEL * 6 + TARGET, 50.0f);
    wrreal(db1 + CHANNEL * 6 + FACTOR, 0.08f);
    wrreal(db1 + CHANNEL * 6 + RATE, 0.40f);
    wrreal(db1 + CHANNEL * 7 + TARGET, 55.0f);
    wrreal(db1 + CHANNEL * 7 + FACTOR, 0.09f);
    wrreal(db1 + CHANNEL * 7 + RATE, 0.45f);
    wrreal(db1 + CHANNEL * 8 + TARGET, 60.0f);
    wrreal(db1 + CHANNEL * 8 + FACTOR, 0.10f);
    wrreal(db1 + CHANNEL * 8 + RATE, 0.50f);
    wrreal(db1 + CHANNEL * 9 + TARGET, 65.0f);
    wrreal(db1 + CHANNEL * 9 + FACTOR, 0.11f);
    wrreal(db1 + CHANNEL * 9 + RATE, 0.55f);
    wrreal(db1 + CHANNEL * 10 + TARGET, 70.0f);
    wrreal(db1 + CHANNEL * 10 + FACTOR, 0.12f);
    wrreal(db1 + CHANNEL * 10 + RATE, 0.60f);
    wrreal(db1 + CHANNEL * 11 + TARGET, 75.0f);
    wrreal(db1 + CHANNEL * 11 + FACTOR, 0.13f);
    wrreal(db1 + CHANNEL * 11 + RATE, 0.65f);
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
    wr32(M, seed);
    wr32(M + 4, random);
    for (unsigned i = 0; i < CHANNELS; i++) {
        uint8_t *c = db1 + CHANNEL * i;
        float scaled = (float)(int)(random >> (i + 4) & 0x7FFF) / 27648.0f * 100.0f;
        wrreal(c + SCALED, scaled);
        float filtered = rdreal(c + FILTERED);
        filtered = (scaled - filtered) * rdreal(c + FACTOR) + filtered;
        wrreal(c + FILTERED, filtered);
        float ramp = rdreal(c + RAMP), target = rdreal(c + TARGET), rate = rdreal(c + RATE);
        float change = target - ramp;
        change = change <= rate ? change : rate;
        change = change >= -rate ? change : -rate;
        ramp += change;
        wrreal(c + RAMP, ramp);
        if (ramp == target) {
            wrreal(c + TARGET, -target);
        }
        bool high = bit(c, STATE, 0), was = bit(c, STATE, 1);
        if (filtered > 62.0f + (float)i) {
            high = true;
        }
        if (filtered < 50.0f + (float)i) {
            high = false;
        }
        c[STATE] = (uint8_t)((c[STATE] & 0xFC) | (high ? 3 : 0));
        c[ALARMS] = (uint8_t)(c[ALARMS] + (high & !was));
    }
}
