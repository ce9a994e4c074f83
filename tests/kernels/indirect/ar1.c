#include "../plc.h"

enum { RECORD = 8, RECORDS = 40, RAW = 0, MEAN = 2, HIGH = 4, STATE = 6, NUMBER = 7, SUM = RECORD * RECORDS, ALARMS = SUM + 4 };

static uint8_t db1[ALARMS + 2];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 4})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M);
    int32_t sum = 0;
    int alarms = 0;
    for (uint8_t *r = db1; r < db1 + RECORD * RECORDS; r += RECORD) {
        seed += 0x9E3779B9u;
        int raw = (seed ^ seed >> 13) & 0x3FF;
        wr16(r + RAW, (uint16_t)raw);
        int mean = (int16_t)(rdint(r + MEAN) * 3 + raw) / 4;
        wr16(r + MEAN, (uint16_t)mean);
        sum += mean;
        if (raw > rdint(r + HIGH)) {
            wr16(r + HIGH, (uint16_t)raw);
            put(r, STATE, 3, true);
        }
        bool alarm = mean > 500;
        bool was = bit(r, STATE, 1);
        put(r, STATE, 0, alarm);
        if (alarm) {
            r[NUMBER]++;
            alarms++;
        }
        put(r, STATE, 1, alarm);
        put(r, STATE, 2, alarm & !was);
    }
    wr32(M, seed);
    wr32(db1 + SUM, (uint32_t)sum);
    wr16(db1 + ALARMS, (uint16_t)alarms);
}
