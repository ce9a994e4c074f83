#include "../plc.h"
enum { SET = 0, RAMPED = 4, FILTERED = 8, OUT = 12, FLAGS = 14, SIZE = 16 };
static uint8_t db[8 * SIZE + 2];
AREAS({"M", M, 4}, {"DB1.DB", db, sizeof db})
void scan(uint32_t now)
{
    (void)now;
    int n = 0;
    for (int i = 0; i < 8; i++) {
        uint8_t *d = db + i * SIZE;
        uint32_t s = rd32(M) + 0x9E3779B9u;
        wr32(M, s);
        uint32_t r = s ^ s >> 15;
        if ((r & 0xF) == 0)
            wrreal(d + SET, (float)((int32_t)(r >> 16) / 256 - 128));
        float set = rdreal(d + SET), target = set < -100.0f ? -100.0f : set > 100.0f ? 100.0f : set;
        float ramped = rdreal(d + RAMPED), diff = target - ramped;
        if (diff > 2.5f) ramped += 2.5f;
        else if (diff < -4.0f) ramped -= 4.0f;
        else ramped = target;
        wrreal(d + RAMPED, ramped);
        float f = rdreal(d + FILTERED);
        f += (ramped - f) * 0.8f;
        wrreal(d + FILTERED, f);
        wr16(d + OUT, fabsf(f) < 0.5f ? 0 : (uint16_t)lrintf(f * 276.48f));
        bool reached = fabsf(target - f) < 1.0f;
        d[FLAGS] = (uint8_t)(reached | (target != set) << 1);
        n += reached;
    }
    wr16(db + 8 * SIZE, (uint16_t)n);
}
