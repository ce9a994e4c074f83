#include "../iec.h"
#include "../plc.h"

enum { NUMBER = 0, CODE = 2, WEIGHT = 4, FLAGS = 12, RECORD = 14, SUM = 4 * RECORD };

static uint8_t records[SUM + 2];

AREAS({"M", M, 21}, {"DB1.DB", records, sizeof records})

static struct station {
    struct timer delay;
    int16_t parts, level;
    bool part, busy, reset, was, full;
    unsigned place;
} line[4];

static void station(struct station *s, bool part, bool reset, int weight, uint8_t *record, uint32_t now)
{
    bool busy = on_delay(&s->delay, part, 3, now);
    if (reset) {
        s->parts = 0;
    } else if (busy && !s->busy && s->parts < INT16_MAX) {
        s->parts++;
    }
    s->busy = busy;
    if (s->parts >= 100) {
        s->level = 5;
    } else {
        bool up = part && !s->part, down = reset && !s->reset;
        if (up != down) {
            s->level = (int16_t)(s->level + (up ? s->level < INT16_MAX : -(s->level > INT16_MIN)));
        }
    }
    s->part = part;
    s->reset = reset;
    s->full = s->level >= 5;
    if (busy && !s->was) {
        s->place = (s->place + 1) % 4;
        wr16(record + WEIGHT + 2 * s->place, (uint16_t)weight);
        wr16(record + NUMBER, (uint16_t)s->parts);
        wr16(record + CODE, (uint16_t)(rd16(record + CODE) ^ weight));
        put(record, FLAGS, 0, weight > 20 && weight < 240);
    }
    put(record, FLAGS, 1, s->full && part);
    s->was = busy;
}

void scan(uint32_t now)
{
    uint32_t seed = rd32(M) + 0x9E3779B9u;
    wr32(M, seed);
    wr32(M + 4, seed ^ seed >> 15);
    M[5] |= M[1];
    bool both = bit(M, 4, 1);
    int weight = rd16(M + 6) & 0xFF;
    station(&line[0], bit(M, 5, 0), bit(M, 4, 0) && both, weight, records, now);
    station(&line[1], bit(M, 5, 1) || line[0].busy, bit(M, 4, 2) && both, weight + 1, records + RECORD, now);
    station(&line[2], bit(M, 5, 2) && !line[1].full, bit(M, 4, 3) && both, weight - 1, records + 2 * RECORD, now);
    station(&line[3], bit(M, 5, 3) || line[2].busy, bit(M, 4, 4) && both, weight, records + 3 * RECORD, now);
    int16_t sum = 0;
    for (unsigned n = 0; n < 4; n++) {
        if (bit(records + n * RECORD, FLAGS, 0)) {
            sum = (int16_t)(sum + rdint(records + n * RECORD + WEIGHT + 2 * n));
        }
        put(M, 20, n, line[n].busy);
        put(M, 20, n + 4, line[n].full);
    }
    wr16(records + SUM, (uint16_t)sum);
}
