#include "../plc.h"

enum { A = 0, B = 40, RESULTS = 64 };

static uint8_t db[RESULTS + 24];

AREAS({"M", M, 8}, {"DB1.DB", db, sizeof db})

static void extremes(const uint8_t *data, int count, uint8_t *result)
{
    int most = INT16_MIN, least = INT16_MAX, place = 0;
    for (int i = 0; i < count; i++) {
        int value = rdint(data + 2 * i);
        if (value > most) {
            most = value;
            place = i;
        }
        if (value < least) {
            least = value;
        }
    }
    wr16(result, (uint16_t)most);
    wr16(result + 2, (uint16_t)least);
    wr16(result + 4, (uint16_t)place);
}

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
    wr32(M, seed);
    wr32(M + 4, random);
    unsigned i = seed >> 16 & 15;
    wr16(db + A + 2 * i, (uint16_t)(random >> 16));
    wr16(db + A + 2 * i + 4, (uint16_t)random);
    wr16(db + B + 2 * (i % 12), (uint16_t)(random >> 16 ^ random));
    extremes(db + A, 20, db + RESULTS);
    extremes(db + B, 12, db + RESULTS + 6);
    extremes(db + A + 10, 8, db + RESULTS + 12);
    extremes(db + A + 20, 12, db + RESULTS + 18);
}
