#include "../plc.h"

enum { SEED = 0, PLACE = 4, VALUES = 8, AVERAGE = 264, LOW = 280, HIGH = 296, SPREAD = 312, ALARMS = 314 };

static uint8_t db1[ALARMS + 4];

AREAS({"DB1.DB", db1, sizeof db1})

void scan(uint32_t now)
{
    (void)now;
    int32_t place = rddint(db1 + PLACE) + 1;
    if (place >= 16) {
        place = 0;
    }
    wr32(db1 + PLACE, (uint32_t)place);
    int32_t seed = rddint(db1 + SEED);
    for (unsigned channel = 0; channel < 4; channel++) {
        uint8_t *values = db1 + VALUES + 64 * channel;
        seed = (seed * 421 + 1663) % 7875;
        wrreal(values + 4 * place, (float)seed / 100.0f - 20.0f);
        float sum = 0, low = rdreal(values), high = low;
        for (int i = 0; i < 16; i++) {
            float value = rdreal(values + 4 * i);
            sum += value;
            if (value < low) {
                low = value;
            }
            if (value > high) {
                high = value;
            }
        }
        wrreal(db1 + AVERAGE + 4 * channel, sum / 16.0f);
        wrreal(db1 + LOW + 4 * channel, low);
        wrreal(db1 + HIGH + 4 * channel, high);
        bool spread = high - low > 75.0f;
        put(db1, SPREAD, channel, spread);
        if (spread) {
            wr32(db1 + ALARMS, rd32(db1 + ALARMS) + 1);
        }
    }
    wr32(db1 + SEED, (uint32_t)seed);
}
