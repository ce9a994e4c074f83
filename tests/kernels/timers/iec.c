#include "../iec.h"
#include "../plc.h"

AREAS({"M", M, 20})

struct station {
    bool start, sensor, run, lamp, full;
    uint32_t delay;
    int16_t parts;
    uint32_t elapsed;
    struct timer on, off, pulse;
    int16_t count;
    bool up;
};

static struct station stations[12];

static void call(struct station *s, bool start, bool sensor, uint32_t delay, uint32_t now)
{
    s->start = start;
    s->sensor = sensor;
    s->delay = delay;
    bool ready = on_delay(&s->on, start, delay, now);
    s->elapsed = s->on.elapsed;
    s->run = off_delay(&s->off, ready & sensor, 25, now);
    s->lamp = pulse(&s->pulse, sensor & !s->run, 40, now);
    if (s->full) {
        s->count = 0;
    } else if (s->lamp && !s->up && s->count < INT16_MAX) {
        s->count++;
    }
    s->up = s->lamp;
    s->full = s->count >= 9;
    s->parts = s->count;
}

void scan(uint32_t now)
{
    uint32_t bits = rd32(M) + 1640531527u;
    wr32(M, bits);
    bits ^= bits >> 15;
    bits ^= bits << 7;
    uint32_t outs = 0, lamps = 0, sum = 0;
    int total = 0;
    for (unsigned i = 0; i < 12; i++) {
        struct station *s = &stations[i];
        call(s, (bits & 0x30000) != 0, bits >> i & 1, 10 + i, now);
        outs |= (uint32_t)s->run << i;
        lamps |= (uint32_t)s->lamp << i;
        total += s->parts;
        sum += s->elapsed;
    }
    wr32(M + 4, outs);
    wr32(M + 8, lamps);
    wr16(M + 12, (uint16_t)total);
    wr32(M + 16, sum);
}
