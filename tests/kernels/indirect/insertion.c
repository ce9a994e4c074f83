#include "../plc.h"

enum { FROM = 32 };

static uint8_t db[FROM + 32];

AREAS({"M", M, 4}, {"DB1.DB", db, sizeof db})

void scan(uint32_t now)
{
    (void)now;
    uint32_t seed = rd32(M);
    for (int n = 0; n < 16; n++) {
        seed += 0x9E3779B9u;
        wr16(db + 2 * n, (uint16_t)(seed ^ seed >> 15));
        wr16(db + FROM + 2 * n, (uint16_t)(16 - n));
    }
    wr32(M, seed);
    for (int k = 1; k < 16; k++) {
        int key = rdint(db + 2 * k), place = rdint(db + FROM + 2 * k), n = k;
        for (; n > 0 && key < rdint(db + 2 * n - 2); n--) {
            memcpy(db + 2 * n, db + 2 * n - 2, 2);
            memcpy(db + FROM + 2 * n, db + FROM + 2 * n - 2, 2);
        }
        wr16(db + 2 * n, (uint16_t)key);
        wr16(db + FROM + 2 * n, (uint16_t)place);
    }
}
