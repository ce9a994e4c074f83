#include "../plc.h"

enum { REALS = 0, INTS = 96, DINTS = 160, RESULTS = 224, PLACE = RESULTS + 4 * 14 };
enum type { INT = 5, DINT = 7, REAL = 8 };

static uint8_t db1[PLACE + 2];

AREAS({"DB1.DB", db1, sizeof db1}, {"M", M, 8})

static void statistics(enum type type, const uint8_t *data, int count, uint8_t *result)
{
    float low = 1e30f, high = -1e30f, sum = 0;
    for (int n = 0; n < count; n++) {
        float value;
        switch (type) {
        case REAL: value = rdreal(data); data += 4; break;
        case DINT: value = (float)rddint(data); data += 4; break;
        default: value = (float)rdint(data); data += 2; break;
        }
        sum = value + sum;
        low = value < low ? value : low;
        high = value > high ? value : high;
    }
    wrreal(result, low);
    wrreal(result + 4, high);
    wrreal(result + 8, sum / (float)count);
    wr16(result + 12, (uint16_t)count);
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    unsigned place = (rd16(db1 + PLACE) + 1) & 15;
    wr16(db1 + PLACE, (uint16_t)place);
    memcpy(db1 + INTS + 2 * place, M + 4, 2);
    int32_t value = rdint(M + 6);
    wr32(db1 + DINTS + 4 * place, (uint32_t)value);
    wrreal(db1 + REALS + 4 * place, (float)value * 0.25f);
    statistics(REAL, db1 + REALS, 24, db1 + RESULTS);
    statistics(INT, db1 + INTS, 32, db1 + RESULTS + 14);
    statistics(DINT, db1 + DINTS, 16, db1 + RESULTS + 28);
    statistics(INT, M, 4, db1 + RESULTS + 42);
}
