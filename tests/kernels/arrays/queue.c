#include "../plc.h"

enum { NUMBER = 0, WEIGHT = 4, TARGET = 8, FLAGS = 10, PARCEL = 12 };
enum { SEED = 0, QUEUE = 4, OUT = QUEUE + 20 * PARCEL, LANES = OUT + PARCEL, TOTAL = LANES + 8, VALID = TOTAL + 4, NEXT = VALID + 2 };

static uint8_t db1[NEXT + 4];

AREAS({"DB1.DB", db1, sizeof db1})

void scan(uint32_t now)
{
    (void)now;
    int32_t seed = (rddint(db1 + SEED) * 421 + 1663) % 7875;
    wr32(db1 + SEED, (uint32_t)seed);
    uint8_t *out = db1 + OUT, *queue = db1 + QUEUE;
    memcpy(out, queue + 19 * PARCEL, PARCEL);
    if (out[FLAGS] & 1) {
        uint8_t *lane = db1 + LANES + 2 * rdint(out + TARGET);
        wr16(lane, (uint16_t)(rd16(lane) + 1));
    }
    memmove(queue + PARCEL, queue, 19 * PARCEL);
    uint32_t number = rd32(db1 + NEXT) + 1;
    wr32(db1 + NEXT, number);
    wr32(queue + NUMBER, number);
    float weight = (float)seed * 0.01f;
    wrreal(queue + WEIGHT, weight);
    wr16(queue + TARGET, (uint16_t)(seed % 4));
    queue[FLAGS] = (uint8_t)((seed % 5 != 0) | (weight > 40.0f) << 1);
    float total = 0;
    int count = 0;
    for (int i = 0; i < 20; i++) {
        uint8_t *parcel = queue + PARCEL * i;
        if (parcel[FLAGS] & 1) {
            total += rdreal(parcel + WEIGHT);
            count++;
            if ((parcel[FLAGS] & 2) && i == 10) {
                parcel[FLAGS] &= (uint8_t)~1u;
            }
        }
    }
    wrreal(db1 + TOTAL, total);
    wr16(db1 + VALID, (uint16_t)count);
}
