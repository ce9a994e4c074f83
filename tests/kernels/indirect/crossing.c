#include "../plc.h"

enum { SOURCE = 0, TARGET = 96, GATHERED = 192, READY = 240, LENGTH = 24 };

static uint8_t db1[READY + 2], db2[96];

AREAS({"DB1.DB", db1, sizeof db1}, {"DB2.DB", db2, sizeof db2}, {"M", M, 150}, {"Q", Q, 64})

/* The byte that an area-crossing pointer names. */
static uint8_t *resolve(uint32_t pointer, uint8_t *db)
{
    uint32_t byte = (pointer & 0x00FFFFFF) >> 3;
    switch (pointer >> 24) {
    case 0x81:
        return I + byte;
    case 0x82:
        return Q + byte;
    case 0x83:
        return M + byte;
    case 0x84:
        return db + byte;
    default:
        abort();
    }
}

static void fill(void)
{
    for (unsigned n = 0; n < LENGTH; n++) {
        uint32_t at = 8 * 100 + 16 * n, target = at - 800;
        wr32(db1 + SOURCE + 4 * n, 0x83000000 | at);
        wr32(db1 + TARGET + 4 * n, ((LENGTH - n) % 4 == 0 ? 0x82000000 : 0x84000000) | target);
    }
}

void scan(uint32_t now)
{
    (void)now;
    if (!bit(db1, READY, 0)) {
        fill();
        put(db1, READY, 0, true);
    }
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 100, seed);
    wr32(M + 122, seed >> 15);
    wr32(M + 140, seed >> 15);
    uint16_t carried = rd16(db1 + GATHERED);
    for (unsigned n = 0; n < LENGTH; n++) {
        const uint8_t *source = resolve(rd32(db1 + SOURCE + 4 * n), db1);
        uint8_t *target = resolve(rd32(db1 + TARGET + 4 * n), db2);
        carried = (uint16_t)(rd16(source) + carried) >> 1;
        wr16(target, carried);
        target[1] = (uint8_t)((target[1] & 0x7F) | (target[1] & 1) << 7);
    }
    wr16(db1 + GATHERED, carried);
}
