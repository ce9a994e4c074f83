#include "../plc.h"

enum { SETPOINT = 0, RAMPED = 4, FILTERED = 8, OUTPUT = 12, FLAGS = 14, SIZE = 16, DRIVES = 8 };

static uint8_t db[DRIVES * SIZE + 2];

AREAS({"M", M, 4}, {"DB1.DB", db, sizeof db})

void scan(uint32_t now)
{
    (void)now;
    int all_reached = 0;
    for (int i = 0; i < DRIVES; i++) {
        uint8_t *drive = db + i * SIZE;
        uint32_t seed = rd32(M) + 0x9E3779B9u, random = seed ^ seed >> 15;
        wr32(M, seed);
        if ((random & 0xF) == 0) {
            wrreal(drive + SETPOINT, (float)((int32_t)(random >> 16) / 256 - 128));
        }
        float setpoint = rdreal(drive + SETPOINT);
        float target = setpoint < -100.0f ? -100.0f : setpoint > 100.0f ? 100.0f : setpoint;
        float ramped = rdreal(drive + RAMPED), difference = target - ramped;
        if (difference > 2.5f) {
            ramped += 2.5f;
        } else if (difference < -4.0f) {
            ramped -= 4.0f;
        } else {
            ramped = target;
        }
        wrreal(drive + RAMPED, ramped);
        float filtered = rdreal(drive + FILTERED);
        filtered += (ramped - filtered) * 0.8f;
        wrreal(drive + FILTERED, filtered);
        wr16(drive + OUTPUT, fabsf(filtered) < 0.5f ? 0 : (uint16_t)lrintf(filtered * 276.48f));
        bool reached = fabsf(target - filtered) < 1.0f;
        drive[FLAGS] = (uint8_t)(reached | (target != setpoint) << 1);
        all_reached += reached;
    }
    wr16(db + DRIVES * SIZE, (uint16_t)all_reached);
}
